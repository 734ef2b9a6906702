# A packing of frictionless spheres and element tests on it by YADE (Debian's package yade):
#   OUT=folder N=500 SEED=1 yade -n -x element_tests.py
# Radii are uniform between 0.5 and 1.5 mm; contacts have the stiffness 1e8 kg/s^2 and the viscosity 1 kg/s, whatever the
# radii: Law2_ScGeom_ViscElPhys_Basic with kn and cn given, of two springs in series, hence twice that. Isotropic loading to
# nu = 0.82, unloading to 0.66 (the test ISO) with states kept on the way, shear at constant volume from them (D2-0.70, D2-0.75).
# OUT/NAME.csv has a row an instant: cell and stress (YADE's sign: tension positive). OUT/NAME/NNN.spheres.txt are the
# spheres of row NNN as export.text writes them (x y z r, six digits), NNN.contacts.txt the contacts: numbers of two spheres,
# from 0 in the order of that file, force on the first, stiffness and overlap.
import math
import os

from yade import export, pack, utils
from yade.minieigenHP import Matrix3, Vector3

out, N, seed = os.environ['OUT'], int(os.environ.get('N', 500)), int(os.environ.get('SEED', 1))
rate, dt, frames = 276.0, 3e-8, 50  # 1/s, s, rows of a test
solid = 0.0


def nu():
  return solid / O.cell.volume



def strain(eps, steps, frame=None):
  """Logarithmic strains eps of the three edges in equal steps; `frame` is called at `frames` equal strains."""
  edges = [O.cell.hSize[a, a] for a in range(3)]
  rates = [e / (steps * O.dt) for e in eps]
  O.cell.velGrad = Matrix3(rates[0], 0, 0, 0, rates[1], 0, 0, 0, rates[2])
  for k in range(1, frames + 1 if frame else 2):
    O.run(steps // frames if frame else steps, True)
    if frame:
      frame(k)
  O.cell.velGrad = Matrix3.Zero
  print('strains', [math.log(O.cell.hSize[a, a] / edges[a]) for a in range(3)], 'nu', nu(), flush=True)


def steps_for(eps, at_rate):
  dev = math.sqrt(((eps[0] - eps[1])**2 + (eps[1] - eps[2])**2 + (eps[2] - eps[0])**2) / 2)
  return frames * math.ceil(max(abs(sum(eps)), dev) / at_rate / O.dt / frames)


class Test:
  def __init__(self, name):
    os.makedirs(f'{out}/{name}', exist_ok=True)
    self.folder, self.begun = f'{out}/{name}', O.time
    self.table = open(f'{out}/{name}.csv', 'w')
    self.table.write('time[s],Lx[m],Ly[m],Lz[m],sxx[Pa],syy[Pa],szz[Pa],syz[Pa],sxz[Pa],sxy[Pa]\n')

  def frame(self, k):
    s, h = utils.getStress(), O.cell.hSize
    row = [O.time - self.begun, h[0, 0], h[1, 1], h[2, 2], s[0, 0], s[1, 1], s[2, 2]]
    row += [(s[a, b] + s[b, a]) / 2 for a, b in ((1, 2), (0, 2), (0, 1))]
    self.table.write(','.join(f'{x:.15g}' for x in row) + '\n')
    self.table.flush()
    export.text(f'{self.folder}/{k:03d}.spheres.txt')
    with open(f'{self.folder}/{k:03d}.contacts.txt', 'w') as contacts:
      contacts.write('#id1 id2 fx fy fz kn overlap\n')
      for i in O.interactions:
        if i.isReal:
          f = -i.phys.normalForce
          contacts.write(f'{i.id1} {i.id2} {f[0]:.17g} {f[1]:.17g} {f[2]:.17g} {i.phys.kn:.17g} {i.geom.penetrationDepth:.17g}\n')


O.periodic = True
edge = (N * 1.25 * 4 / 3 * math.pi * 1e-9 / 0.3)**(1 / 3)
O.cell.setBox(edge, edge, edge)
material = O.materials.append(ViscElMat(density=2000, kn=2e8, cn=2, ks=0, cs=0, frictionAngle=0))
cloud = pack.SpherePack()
cloud.makeCloud(Vector3(0, 0, 0), Vector3(edge, edge, edge), rMean=1e-3, rRelFuzz=0.5, num=N, periodic=True, seed=seed)
cloud.toSimulation(material=material)
solid = sum(4 / 3 * math.pi * b.shape.radius**3 for b in O.bodies)
newton = NewtonIntegrator(damping=0.2)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=-0.1, allowBiggerThanPeriod=True),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()], [Law2_ScGeom_ViscElPhys_Basic()]),
    newton
]
O.dt = dt
print('spheres', len(O.bodies), 'nu', nu(), flush=True)


def isotropic(to_nu):
  e = -math.log(to_nu / nu()) / 3
  return (e, e, e)


gas = isotropic(0.64)
strain(gas, steps_for(gas, 10 * rate))
O.run(5000, True)
load = isotropic(0.82)
strain(load, steps_for(load, rate))
print('kn of the contacts', {i.phys.kn for i in O.interactions if i.isReal}, flush=True)

kept, wanted = {}, [0.75, 0.70]
unloading = Test('ISO')
unloading.frame(0)


def unload(k):
  unloading.frame(k)
  if wanted and nu() <= wanted[0]:
    density = wanted.pop(0)
    O.saveTmp(str(density))
    kept[density] = nu()


release = isotropic(0.66)
strain(release, steps_for(release, rate), unload)
for density in kept:
  O.loadTmp(str(density))
  newton = O.engines[3]
  O.cell.velGrad = Matrix3.Zero
  O.run(5000, True)
  shear = Test(f'D2-{density:.2f}')
  shear.frame(0)
  e = 0.26 / math.sqrt(3)
  strain((e, 0, -e), steps_for((e, 0, -e), rate), shear.frame)
