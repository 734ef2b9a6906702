#!/usr/bin/env python3
"""scipy_law.py STUDY.json: Eq. (16) along the study's smooth path (UNI, nu = .695 to .82) by SciPy's solve_ivp, beside what
`grainlaw study integrator` measured. Same equations, same parameters (the study's `values`), same unknowns P*, sigma'*, F'
in the coordinates of model/vocabulary/tensor.hpp; the end of the path must agree with the study's reference. Prints for each method the
least time with an error of at most 1e-6 and its ratio to ours. Run pinned to one core on a quiet machine."""

import json
import sys
import time
from math import exp, log

import numpy as np
from scipy.integrate import solve_ivp

NU_0, NU_END, WANTED = 0.695, 0.82, 1e-6
N = np.array([1.0, 0, 0, 0, 0])  # compression of z


def law(v):
    """Returns P*(nu) of Eq. (14) and the right-hand side of Eq. (16), coupling energy."""
    C1, alpha, nu_cC = (v["coordination." + k] for k in ("C1", "alpha", "nu_c"))
    phi_c, phi_v = (v["rattlers." + k] for k in ("phi_c", "phi_v"))
    p0, g, nu_cP = (v["pressure." + k] for k in ("p0", "gamma_p", "nu_c"))
    nu_s, a2 = v["shear.nu_c"], v["anisotropy.a2"]
    laws = [[v[q + k] for k in (".Q_limit", ".Q_c", ".alpha")]
            for q in ("stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate")]

    def P_and_B(nu):
        x, y = log(nu / nu_cP), nu / nu_cC - 1
        phi, C_star = phi_c * exp(-phi_v * y), 6 + C1 * y**alpha
        dlnC = phi_v * (1 + y) * phi / (1 - phi) + C1 * alpha * y**(alpha - 1) * (1 + y) / C_star
        unit = p0 * nu * (1 - phi) * C_star / nu_cP
        return unit * x * (1 - g * x), unit * (1 - 2 * g * x + x * (1 - g * x) * (1 + dlnC))

    def rate(e, state):
        nu = NU_0 * exp(e)
        _, B = P_and_B(nu)
        s_max, beta_s, F_max, beta_F = (q + c * exp(-a * (nu / nu_s - 1)) for q, c, a in laws)
        P, sigma, F = state[0], state[1:6], state[6:11]
        A1 = (2 / 3) * (a2 * B * F[0] - sigma[0])
        out = np.empty(11)
        out[0] = B + A1 * (1 - sigma[0] / (P * s_max))
        out[1:6] = a2 * B * F + beta_s * (s_max * P * N - sigma)
        out[6:11] = beta_F * (F_max * N - F)
        return out

    return P_and_B, rate


def main():
    study = json.load(open(sys.argv[1]))
    panel = next(p for p in study["panels"] if p["path"] == "smooth")
    assert study["coupling"] == "energy", "the script has the energy coupling only"
    P_and_B, rate = law(study["values"])
    start = np.zeros(11)
    start[0] = P_and_B(NU_0)[0]
    length = log(NU_END / NU_0)

    def solve(method, rtol):
        before = time.perf_counter()
        run = solve_ivp(rate, (0, length), start, method=method, rtol=rtol, atol=1e-4 * rtol)
        return run.y[:, -1], 1e6 * (time.perf_counter() - before), run.nfev

    reference, _, _ = solve("DOP853", 1e-13)
    end = panel["end"]
    measured = {"P_star": reference[0], "s_dev": np.linalg.norm(reference[1:6]) / reference[0],
                "F_dev": np.linalg.norm(reference[6:11])}
    for name, value in measured.items():
        if abs(value - end[name]) > 1e-9 * abs(end[name]):
            sys.exit(f"scipy_law: {name} ends at {value:.12g}, the study at {end[name]:.12g}: not the same equations")

    ours = {p["integrator"]: p for p in panel["quickest_within_1e-6"]}
    for name in ("adams", "erk_5"):
        print(f"ours  {name:7} {ours[name]['microseconds']:9.1f} us  {ours[name]['rhs_evaluations']:5} right-hand sides")
    for method in ("RK45", "DOP853", "LSODA", "BDF"):
        best = None
        for decade in range(3, 11):
            runs = [solve(method, 10.0**-decade) for _ in range(5)]
            y, _, evaluations = runs[0]
            error = max(abs(y[0] / reference[0] - 1), np.linalg.norm(y[1:6] - reference[1:6]) / reference[0],
                        np.linalg.norm(y[6:11] - reference[6:11]))
            least = min(run[1] for run in runs)
            if error <= WANTED and (best is None or least < best[0]):
                best = least, evaluations
        print(f"scipy {method:7} {best[0]:9.1f} us  {best[1]:5} right-hand sides  "
              f"{best[0] / ours['adams']['microseconds']:.0f} times adams, {best[0] / ours['erk_5']['microseconds']:.0f} times erk_5")


if __name__ == "__main__":
    main()
