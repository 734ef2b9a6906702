#include "dem/lane_pass.hpp"

#include <algorithm>
#include <bit>

// The code between foreach_target.h and HWY_ONCE is compiled once for each kind of vector instructions.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)  // nothing of theirs is used
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem/lane_pass.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainlaw::dem {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

template <class Real>
using Tag = hn::CappedTag<Real, kLanes>;

// --- a b + c, rounded once -----------------------------------------------------------------------------------------
// Fused where the machine has it (AVX2, AVX-512). Elsewhere the product is rounded, too, unless the same bits are asked
// for: then the fused operation is composed of others.
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
constexpr bool kHasFused = true;
#else
constexpr bool kHasFused = false;
#endif

/// x + y and what rounding took from it.
template <class V>
struct Exact {
  V sum, rest;
};

template <class V>
HWY_INLINE Exact<V> add_exactly(V x, V y) {
  const V sum = hn::Add(x, y), part = hn::Sub(sum, x);
  return {sum, hn::Add(hn::Sub(x, hn::Sub(sum, part)), hn::Sub(y, part))};
}

/// x + y rounded to odd: an inexact sum gets an odd last bit, so that a second rounding does no harm.
template <class D, class V>
HWY_INLINE V add_to_odd(D d, V x, V y) {
  const hn::RebindToSigned<D> di;
  const Exact<V> e = add_exactly(x, y);
  const auto bits = hn::BitCast(di, e.sum);
  const auto one = hn::Set(di, 1);
  const auto even = hn::Eq(hn::And(bits, one), hn::Zero(di));
  const auto inexact = hn::RebindMask(di, hn::Ne(e.rest, hn::Zero(d)));
  // towards zero where the rest has not the sign of the sum
  const auto inward = hn::Lt(hn::Xor(bits, hn::BitCast(di, e.rest)), hn::Zero(di));
  const auto odd = hn::Add(bits, hn::IfThenElse(inward, hn::Set(di, -1), one));
  return hn::BitCast(d, hn::IfThenElse(hn::And(even, inexact), odd, bits));
}

/// The fused operation from double-precision ones (S. Boldo, G. Melquiond, IEEE Trans. Comput. 57 (2008) 462).
template <class V>
HWY_INLINE V fused_double(V a, V b, V c) {
  const hn::DFromV<V> d;
  const V splitter = hn::Set(d, 0x1p27 + 1);
  const auto head = [&](V x) {
    const V scaled = hn::Mul(splitter, x);
    return hn::Sub(scaled, hn::Sub(scaled, x));
  };
  const V ah = head(a), bh = head(b), al = hn::Sub(a, ah), bl = hn::Sub(b, bh), product = hn::Mul(a, b);
  const V rest = hn::Add(hn::Add(hn::Add(hn::Sub(hn::Mul(ah, bh), product), hn::Mul(ah, bl)), hn::Mul(al, bh)), hn::Mul(al, bl));
  const Exact<V> low = add_exactly(c, rest), high = add_exactly(product, low.sum);
  return hn::Add(high.sum, add_to_odd(d, low.rest, high.rest));
}

template <class V>
HWY_INLINE V fused_float(V a, V b, V c) {
  const hn::DFromV<V> d;
#if HWY_TARGET == HWY_SCALAR
  const hn::Rebind<double, hn::DFromV<V>> dd;
  return hn::DemoteTo(d, add_to_odd(dd, hn::Mul(hn::PromoteTo(dd, a), hn::PromoteTo(dd, b)), hn::PromoteTo(dd, c)));
#else
  const hn::Half<hn::DFromV<V>> half;
  const hn::Repartition<double, hn::DFromV<V>> dd;
  const auto part = [&](auto a2, auto b2, auto c2) {  // products of floats are exact
    return hn::DemoteTo(half, add_to_odd(dd, hn::Mul(hn::PromoteTo(dd, a2), hn::PromoteTo(dd, b2)), hn::PromoteTo(dd, c2)));
  };
  return hn::Combine(d, part(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c)),
                     part(hn::LowerHalf(half, a), hn::LowerHalf(half, b), hn::LowerHalf(half, c)));
#endif
}

/// How a b + c is rounded.
template <bool portable>
struct MultiplyAdd {
  template <class V>
  HWY_INLINE V operator()(V a, V b, V c) const {
    if constexpr (kHasFused || !portable) {
      return hn::MulAdd(a, b, c);
    } else if constexpr (sizeof(hn::TFromV<V>) == 8) {
      return fused_double(a, b, c);
    } else {
      return fused_float(a, b, c);
    }
  }
};

// --- Rows and vectors --------------------------------------------------------------------------------------------
// A row is cut into pieces of 16 bytes. A vector of pieces of the rows k, k + m, k + 2m ... (m numbers to a piece)
// becomes, transposed with its m - 1 siblings, m vectors of one field each, lanes in the order of rows.

template <class D>
struct Quartet {
  hn::Vec<D> a, b, c, d;
};

#if HWY_TARGET == HWY_SCALAR  // vectors of one lane know no transposition
template <class D, class Real>
HWY_INLINE Quartet<D> gather_rows(D d, const Real* rows, const std::uint32_t* row, std::size_t from) {
  const Real* p = reinterpret_cast<const Real*>(reinterpret_cast<const char*>(rows) + row[0]) + from;
  return {hn::Load(d, p), hn::Load(d, p + 1), hn::Load(d, p + 2), hn::Load(d, p + 3)};
}

template <class D, class Real>
HWY_INLINE void store_rows(D d, const Quartet<D>& q, Real* rows, std::size_t from) {
  hn::Store(q.a, d, rows + from);
  hn::Store(q.b, d, rows + from + 1);
  hn::Store(q.c, d, rows + from + 2);
  hn::Store(q.d, d, rows + from + 3);
}
#else
template <class D, class Real>
HWY_INLINE hn::Vec<D> gather_pieces(D d, const Real* rows, const std::uint32_t* row, std::size_t piece) {
  constexpr std::size_t m = 16 / sizeof(Real);
  if constexpr (hn::MaxLanes(D()) == m) {
    return hn::Load(d, reinterpret_cast<const Real*>(reinterpret_cast<const char*>(rows) + row[0]) + piece * m);
  } else {
    const hn::Half<D> half;
    const auto lower = gather_pieces(half, rows, row, piece);
    const auto upper = gather_pieces(half, rows, row + hn::MaxLanes(half), piece);
    return hn::Combine(d, upper, lower);
  }
}

template <class D, class Real>
HWY_INLINE void store_pieces(D d, hn::Vec<D> v, Real* row) {
  constexpr std::size_t m = 16 / sizeof(Real);
  if constexpr (hn::MaxLanes(D()) == m) {
    hn::Store(v, d, row);
  } else {
    const hn::Half<D> half;
    store_pieces(half, hn::LowerHalf(half, v), row);
    store_pieces(half, hn::UpperHalf(half, v), row + hn::MaxLanes(half) * 8);
  }
}

/// Four fields of the rows, from the half of them that begins at number `from` (0 or 4).
template <class D>
HWY_INLINE Quartet<D> gather_rows(D d, const float* rows, const std::uint32_t* row, std::size_t from) {
  const hn::Repartition<double, D> pairs;
  const auto p0 = gather_pieces(d, rows, row, from / 4), p1 = gather_pieces(d, rows, row + 1, from / 4),
             p2 = gather_pieces(d, rows, row + 2, from / 4), p3 = gather_pieces(d, rows, row + 3, from / 4);
  const auto ab01 = hn::BitCast(pairs, hn::InterleaveLower(d, p0, p1)), cd01 = hn::BitCast(pairs, hn::InterleaveUpper(d, p0, p1)),
             ab23 = hn::BitCast(pairs, hn::InterleaveLower(d, p2, p3)), cd23 = hn::BitCast(pairs, hn::InterleaveUpper(d, p2, p3));
  return {hn::BitCast(d, hn::InterleaveLower(pairs, ab01, ab23)), hn::BitCast(d, hn::InterleaveUpper(pairs, ab01, ab23)),
          hn::BitCast(d, hn::InterleaveLower(pairs, cd01, cd23)), hn::BitCast(d, hn::InterleaveUpper(pairs, cd01, cd23))};
}

template <class D>
HWY_INLINE Quartet<D> gather_rows(D d, const double* rows, const std::uint32_t* row, std::size_t from) {
  const auto p0 = gather_pieces(d, rows, row, from / 2), p1 = gather_pieces(d, rows, row + 1, from / 2);
  const auto q0 = gather_pieces(d, rows, row, from / 2 + 1), q1 = gather_pieces(d, rows, row + 1, from / 2 + 1);
  return {hn::InterleaveLower(d, p0, p1), hn::InterleaveUpper(d, p0, p1), hn::InterleaveLower(d, q0, q1),
          hn::InterleaveUpper(d, q0, q1)};
}

/// The other way: four fields into consecutive rows.
template <class D>
HWY_INLINE void store_rows(D d, const Quartet<D>& q, float* rows, std::size_t from) {
  const hn::Repartition<double, D> pairs;
  const auto ab01 = hn::BitCast(pairs, hn::InterleaveLower(d, q.a, q.b)), ab23 = hn::BitCast(pairs, hn::InterleaveUpper(d, q.a, q.b)),
             cd01 = hn::BitCast(pairs, hn::InterleaveLower(d, q.c, q.d)), cd23 = hn::BitCast(pairs, hn::InterleaveUpper(d, q.c, q.d));
  store_pieces(d, hn::BitCast(d, hn::InterleaveLower(pairs, ab01, cd01)), rows + from);
  store_pieces(d, hn::BitCast(d, hn::InterleaveUpper(pairs, ab01, cd01)), rows + from + 8);
  store_pieces(d, hn::BitCast(d, hn::InterleaveLower(pairs, ab23, cd23)), rows + from + 16);
  store_pieces(d, hn::BitCast(d, hn::InterleaveUpper(pairs, ab23, cd23)), rows + from + 24);
}

template <class D>
HWY_INLINE void store_rows(D d, const Quartet<D>& q, double* rows, std::size_t from) {
  store_pieces(d, hn::InterleaveLower(d, q.a, q.b), rows + from);
  store_pieces(d, hn::InterleaveUpper(d, q.a, q.b), rows + from + 8);
  store_pieces(d, hn::InterleaveLower(d, q.c, q.d), rows + from + 2);
  store_pieces(d, hn::InterleaveUpper(d, q.c, q.d), rows + from + 10);
}
#endif

// --- Fixed point -------------------------------------------------------------------------------------------------

/// `steps`, of magnitude below 2^29 or 2^49, rounded to the next quantum of the fixed point.
template <class D>
HWY_INLINE auto to_fixed(D d, hn::Vec<D> steps) {
  if constexpr (sizeof(hn::TFromD<D>) == 4) {
    return hn::NearestInt(steps);
  } else {
    const hn::RebindToSigned<D> di;
    const auto magic = hn::Set(d, 0x1.8p52);  // the sum's last bit is worth 1
    return hn::ShiftLeft<12>(hn::Sub(hn::BitCast(di, hn::Add(steps, magic)), hn::BitCast(di, magic)));
  }
}

/// Cell edge over 2^32 or 2^64 as a sum of two Reals, so that it is not rounded for all pairs alike.
template <class D, bool portable>
struct Edge {
  hn::Vec<D> head, tail;
  Edge(D d, double edge) {
    using Real = hn::TFromD<D>;
    const double scale = edge / kStepsPerEdge<Real>;
    const auto rounded = static_cast<Real>(scale);
    head = hn::Set(d, rounded);
    tail = hn::Set(d, static_cast<Real>(scale - static_cast<double>(rounded)));
  }
  template <class VI>
  HWY_INLINE hn::Vec<D> operator()(D d, VI difference) const {
    const auto c = hn::ConvertTo(d, difference);
    if constexpr (sizeof(hn::TFromD<D>) == 4) {
      return MultiplyAdd<portable>()(c, head, hn::Mul(c, tail));
    } else {
      return hn::Mul(c, head);
    }
  }
};

// --- Sums --------------------------------------------------------------------------------------------------------

/// Sums by lane in double precision.
struct alignas(64) LaneTotals {
  double box[kLanes] = {}, contact[kLanes] = {}, v2[kLanes] = {};
};

template <class D>
HWY_INLINE void add_to(double* sum, D d, hn::Vec<D> v) {
  if constexpr (sizeof(hn::TFromD<D>) == 8) {
    hn::Store(hn::Add(hn::Load(d, sum), v), d, sum);
  } else {
#if HWY_TARGET == HWY_SCALAR
    *sum += static_cast<double>(hn::GetLane(v));
#else
    const hn::Repartition<double, D> dd;
    const hn::Half<D> half;
    const std::size_t n = hn::Lanes(dd);
    hn::Store(hn::Add(hn::Load(dd, sum), hn::PromoteTo(dd, hn::LowerHalf(half, v))), dd, sum);
    hn::Store(hn::Add(hn::Load(dd, sum + n), hn::PromoteTo(dd, hn::UpperHalf(half, v))), dd, sum + n);
#endif
  }
}

double sum_of(const double* lane) {
  double sum = 0;
  for (std::size_t l = 0; l < kLanes; ++l) sum += lane[l];
  return sum;
}

// --- Passes ------------------------------------------------------------------------------------------------------

/// Rows of the vector of spheres at `o` of group g, velocities predicted by h.
template <bool portable, class Real, class V>
HWY_INLINE void write_row_vector(Lanes<Real>& lanes, std::size_t g, std::size_t o, V h) {
  const Tag<Real> d;
  const MultiplyAdd<portable> multiply_add;
  const SphereGroup<Real>& own = lanes.group[g];
  const auto place = [&](const FixedPoint<Real>* x) { return hn::BitCast(d, hn::Load(hn::RebindToSigned<Tag<Real>>(), x + o)); };
  const auto predicted = [&](const Real* v, const Real* a) { return multiply_add(h, hn::Load(d, a + o), hn::Load(d, v + o)); };
  Real* rows = reinterpret_cast<Real*>(lanes.row.data() + g * kLanes + o);
  store_rows(d, Quartet<Tag<Real>>{place(own.x), place(own.y), place(own.z), hn::Load(d, own.radius + o)}, rows, 0);
  store_rows(d, Quartet<Tag<Real>>{predicted(own.vx, own.ax), predicted(own.vy, own.ay), predicted(own.vz, own.az), hn::Zero(d)},
             rows, 4);
}

template <bool portable, class Real>
void write_rows_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const auto h = hn::Set(d, static_cast<Real>(step.half_dt));
  for (std::size_t g = begin; g < end; ++g) {
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) write_row_vector<portable>(lanes, g, o, h);
  }
}

template <bool portable, class Real>
Drifted kick_and_drift_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const MultiplyAdd<portable> multiply_add;
  const hn::RebindToSigned<Tag<Real>> di;
  using V = hn::Vec<Tag<Real>>;
  using Int = FixedPoint<Real>;
  const auto set = [&](double x) { return hn::Set(d, static_cast<Real>(x)); };
  const V h = set(step.half_dt);
  const V drift_x = set(step.drift[0]), drift_y = set(step.drift[1]), drift_z = set(step.drift[2]);
  const Edge<Tag<Real>, portable> ex(d, step.edge[0]), ey(d, step.edge[1]), ez(d, step.edge[2]);
  const V limit = set(sizeof(Real) == 4 ? 0x1p29 : 0x1p49);
  const V allowed2 = set(step.allowed > 0 ? step.allowed * step.allowed : -1),
          near_allowed2 = set(step.near_allowed > 0 ? step.near_allowed * step.near_allowed : -1);
  auto sane = hn::Eq(limit, limit), listed = sane, near = sane;
  for (std::size_t g = begin; g < end; ++g) {
    SphereGroup<Real>& own = lanes.group[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const V ax = hn::Load(d, own.ax + o), ay = hn::Load(d, own.ay + o), az = hn::Load(d, own.az + o);
      const V vx = multiply_add(h, ax, hn::Load(d, own.vx + o)), vy = multiply_add(h, ay, hn::Load(d, own.vy + o)),
              vz = multiply_add(h, az, hn::Load(d, own.vz + o));
      hn::Store(vx, d, own.vx + o);
      hn::Store(vy, d, own.vy + o);
      hn::Store(vz, d, own.vz + o);
      const V dx = hn::Mul(vx, drift_x), dy = hn::Mul(vy, drift_y), dz = hn::Mul(vz, drift_z);
      sane = hn::And(sane, hn::Lt(hn::Add(hn::Add(hn::Abs(dx), hn::Abs(dy)), hn::Abs(dz)), limit));
      const auto x = hn::Add(hn::Load(di, own.x + o), to_fixed(d, dx)), y = hn::Add(hn::Load(di, own.y + o), to_fixed(d, dy)),
                 z = hn::Add(hn::Load(di, own.z + o), to_fixed(d, dz));
      hn::Store(x, di, own.x + o);
      hn::Store(y, di, own.y + o);
      hn::Store(z, di, own.z + o);
      const auto moved2 = [&](const Int* from_x, const Int* from_y, const Int* from_z) {
        const V ux = ex(d, hn::Sub(x, hn::Load(di, from_x + o))), uy = ey(d, hn::Sub(y, hn::Load(di, from_y + o))),
                uz = ez(d, hn::Sub(z, hn::Load(di, from_z + o)));
        return multiply_add(ux, ux, multiply_add(uy, uy, hn::Mul(uz, uz)));
      };
      listed = hn::And(listed, hn::Lt(moved2(own.ref_x, own.ref_y, own.ref_z), allowed2));
      near = hn::And(near, hn::Lt(moved2(own.near_x, own.near_y, own.near_z), near_allowed2));
      write_row_vector<portable>(lanes, g, o, h);
    }
  }
  if (!hn::AllTrue(d, sane)) return Drifted::lost;
  if (!hn::AllTrue(d, listed)) return Drifted::beyond_list;
  return hn::AllTrue(d, near) ? Drifted::well : Drifted::beyond_near;
}

template <class Real>
void pick_near_on(Lanes<Real>& lanes, const std::array<double, 3>& edge, double near_skin, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const hn::RebindToSigned<Tag<Real>> di;
  using V = hn::Vec<Tag<Real>>;
  const Edge<Tag<Real>, false> ex(d, edge[0]), ey(d, edge[1]), ez(d, edge[2]);
  const Real* rows = reinterpret_cast<const Real*>(lanes.row.data());
  const auto nobody = static_cast<std::uint32_t>((lanes.row.size() - 1) * sizeof(SphereRow<Real>));
  for (std::size_t g = begin; g < end; ++g) {
    SphereGroup<Real>& own = lanes.group[g];
    std::uint32_t count[kLanes] = {};
    Rung* picked = lanes.near_rung.data() + lanes.first_rung[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto x = hn::Load(di, own.x + o), y = hn::Load(di, own.y + o), z = hn::Load(di, own.z + o);
      hn::Store(x, di, own.near_x + o);
      hn::Store(y, di, own.near_y + o);
      hn::Store(z, di, own.near_z + o);
      const V reach = hn::Add(hn::Load(d, own.radius + o), hn::Set(d, static_cast<Real>(near_skin)));
      for (std::size_t rung = lanes.first_rung[g]; rung < lanes.first_rung[g + 1]; ++rung) {
        const std::uint32_t* row = lanes.rung[rung].row + o;
        const Quartet<Tag<Real>> place = gather_rows(d, rows, row, 0);
        const V dx = ex(d, hn::Sub(x, hn::BitCast(di, place.a))), dy = ey(d, hn::Sub(y, hn::BitCast(di, place.b))),
                dz = ez(d, hn::Sub(z, hn::BitCast(di, place.c)));
        const V both = hn::Max(hn::Add(reach, place.d), hn::Zero(d));
        const auto near = hn::Lt(hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx))), hn::Mul(both, both));
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(d, near, bytes);
        for (std::uint32_t bits = bytes[0] | std::uint32_t{bytes[1]} << 8; bits != 0; bits &= bits - 1) {
          const auto l = static_cast<std::size_t>(std::countr_zero(bits));
          picked[count[o + l]++].row[o + l] = row[l];
        }
      }
    }
    const std::uint32_t longest = *std::max_element(count, count + kLanes);
    for (std::size_t l = 0; l < kLanes; ++l) {
      for (std::uint32_t k = count[l]; k < longest; ++k) picked[k].row[l] = nobody;
    }
    lanes.near_count[g] = longest;
  }
}

template <bool portable, class Real>
LaneSums force_and_kick_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const MultiplyAdd<portable> multiply_add;
  const hn::RebindToSigned<Tag<Real>> di;
  using V = hn::Vec<Tag<Real>>;
  const auto set = [&](double x) { return hn::Set(d, static_cast<Real>(x)); };
  const V h = set(step.half_dt), k = set(step.stiffness), minus_gamma = set(-step.viscosity),
          gamma_b = set(step.drag), one = set(1), zero = hn::Zero(d);
  const V Lx = set(step.rate[0]), Ly = set(step.rate[1]), Lz = set(step.rate[2]);
  const Edge<Tag<Real>, portable> ex(d, step.edge[0]), ey(d, step.edge[1]), ez(d, step.edge[2]);
  const Real* rows = reinterpret_cast<const Real*>(lanes.row.data());
  LaneTotals totals;
  for (std::size_t g = begin; g < end; ++g) {
    SphereGroup<Real>& own = lanes.group[g];
    const std::size_t first_rung = lanes.first_rung[g], last_rung = first_rung + lanes.near_count[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto x = hn::Load(di, own.x + o), y = hn::Load(di, own.y + o), z = hn::Load(di, own.z + o);
      const V r = hn::Load(d, own.radius + o);
      const V vx = hn::Load(d, own.vx + o), vy = hn::Load(d, own.vy + o), vz = hn::Load(d, own.vz + o);
      const V wx = multiply_add(h, hn::Load(d, own.ax + o), vx), wy = multiply_add(h, hn::Load(d, own.ay + o), vy),
              wz = multiply_add(h, hn::Load(d, own.az + o), vz);
      V fx = zero, fy = zero, fz = zero;        // force
      V gx = zero, gy = zero, gz = zero;        // its viscous part
      V box = zero, lost = zero;
      for (std::size_t rung = first_rung; rung < last_rung; ++rung) {
        const std::uint32_t* row = lanes.near_rung[rung].row + o;
        const Quartet<Tag<Real>> place = gather_rows(d, rows, row, 0), motion = gather_rows(d, rows, row, 4);
        const V dx = ex(d, hn::Sub(x, hn::BitCast(di, place.a))), dy = ey(d, hn::Sub(y, hn::BitCast(di, place.b))),
                dz = ez(d, hn::Sub(z, hn::BitCast(di, place.c)));
        const V distance = hn::Sqrt(multiply_add(dz, dz, multiply_add(dy, dy, hn::Mul(dx, dx))));
        const V delta = hn::Sub(hn::Add(r, place.d), distance);
        const auto touching = hn::Gt(delta, zero);
        const V inverse = hn::Div(one, distance);
        // u . x_ij, of the cell and with the spheres' own velocities
        const V cell = multiply_add(hn::Mul(Lz, dz), dz, multiply_add(hn::Mul(Ly, dy), dy, hn::Mul(hn::Mul(Lx, dx), dx)));
        const V u = multiply_add(hn::Sub(wz, motion.c), dz,
                                 multiply_add(hn::Sub(wy, motion.b), dy, multiply_add(hn::Sub(wx, motion.a), dx, cell)));
        const V viscous = hn::Mul(minus_gamma, hn::Mul(u, inverse));
        // force and viscous part over |x_ij|
        const V f = hn::IfThenElseZero(touching, hn::Mul(multiply_add(k, delta, viscous), inverse));
        const V v = hn::IfThenElseZero(touching, hn::Mul(viscous, inverse));
        fx = multiply_add(f, dx, fx);
        fy = multiply_add(f, dy, fy);
        fz = multiply_add(f, dz, fz);
        gx = multiply_add(v, dx, gx);
        gy = multiply_add(v, dy, gy);
        gz = multiply_add(v, dz, gz);
        box = multiply_add(f, cell, box);
        lost = multiply_add(v, cell, lost);
      }
      const V inverse_mass = hn::Load(d, own.inverse_mass + o);
      const V damped = hn::Div(one, multiply_add(hn::Mul(h, gamma_b), inverse_mass, one));
      const V hm = hn::Mul(h, inverse_mass);
      const V nx = hn::Mul(multiply_add(hm, fx, vx), damped), ny = hn::Mul(multiply_add(hm, fy, vy), damped),
              nz = hn::Mul(multiply_add(hm, fz, vz), damped);
      hn::Store(nx, d, own.vx + o);
      hn::Store(ny, d, own.vy + o);
      hn::Store(nz, d, own.vz + o);
      hn::Store(hn::Mul(hn::Sub(fx, hn::Mul(gamma_b, nx)), inverse_mass), d, own.ax + o);
      hn::Store(hn::Mul(hn::Sub(fy, hn::Mul(gamma_b, ny)), inverse_mass), d, own.ay + o);
      hn::Store(hn::Mul(hn::Sub(fz, hn::Mul(gamma_b, nz)), inverse_mass), d, own.az + o);
      // every contact is met twice: halves of what belongs to it, all of -sum F_v . v
      lost = multiply_add(set(0.5), lost, multiply_add(gz, nz, multiply_add(gy, ny, hn::Mul(gx, nx))));
      add_to(totals.box + o, d, box);
      add_to(totals.contact + o, d, lost);
      add_to(totals.v2 + o, d, multiply_add(nz, nz, multiply_add(ny, ny, hn::Mul(nx, nx))));
    }
  }
  return {-0.5 * sum_of(totals.box), -sum_of(totals.contact), sum_of(totals.v2)};
}

std::size_t find_near_on(const SearchField& field, std::size_t i, std::span<const SearchRange> ranges, std::uint32_t* found) {
  const Tag<float> d;
  const hn::RebindToSigned<Tag<float>> di;
  const auto x = hn::Set(di, field.x[i]), y = hn::Set(di, field.y[i]), z = hn::Set(di, field.z[i]);
  const auto reach = hn::Set(d, field.reach[i]);
  const auto ex = hn::Set(d, field.edge[0]), ey = hn::Set(d, field.edge[1]), ez = hn::Set(d, field.edge[2]);
  const auto self = hn::Set(di, static_cast<std::int32_t>(i)), lane = hn::Iota(di, 0);
  std::size_t count = 0;
  for (const SearchRange& range : ranges) {
    const auto end = hn::Set(di, static_cast<std::int32_t>(range.end));
    for (std::size_t p = range.begin; p < range.end; p += hn::Lanes(d)) {
      const auto dx = hn::Mul(hn::ConvertTo(d, hn::Sub(x, hn::LoadU(di, field.x + p))), ex),
                 dy = hn::Mul(hn::ConvertTo(d, hn::Sub(y, hn::LoadU(di, field.y + p))), ey),
                 dz = hn::Mul(hn::ConvertTo(d, hn::Sub(z, hn::LoadU(di, field.z + p))), ez);
      // not fused: one list everywhere
      const auto d2 = hn::Add(hn::Mul(dz, dz), hn::Add(hn::Mul(dy, dy), hn::Mul(dx, dx)));
      const auto both = hn::Add(reach, hn::LoadU(d, field.reach + p));
      const auto index = hn::Add(lane, hn::Set(di, static_cast<std::int32_t>(p)));
      auto near = hn::RebindMask(di, hn::Lt(d2, hn::Mul(both, both)));
      near = hn::And(near, hn::And(hn::Ne(index, self), hn::Lt(index, end)));
      if (hn::AllFalse(di, near)) continue;
      hn::StoreU(hn::Compress(index, near), di, reinterpret_cast<std::int32_t*>(found + count));
      count += hn::CountTrue(di, near);
    }
  }
  return count;
}

// What HWY_EXPORT needs: plain functions. One instance is enough where the machine can fuse.
#define GRAINLAW_BY_BITS(function, ...) \
  (step.portable_bits && !kHasFused ? function<!kHasFused>(__VA_ARGS__) : function<false>(__VA_ARGS__))
#define GRAINLAW_PASSES(Real, name)                                                                               \
  void write_rows_##name(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {          \
    GRAINLAW_BY_BITS(write_rows_on, lanes, step, begin, end);                                                     \
  }                                                                                                               \
  Drifted kick_and_drift_##name(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {    \
    return GRAINLAW_BY_BITS(kick_and_drift_on, lanes, step, begin, end);                                          \
  }                                                                                                               \
  LaneSums force_and_kick_##name(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {  \
    return GRAINLAW_BY_BITS(force_and_kick_on, lanes, step, begin, end);                                          \
  }                                                                                                               \
  void pick_near_##name(Lanes<Real>& lanes, const std::array<double, 3>& edge, double near_skin, std::size_t begin, \
                        std::size_t end) {                                                                        \
    pick_near_on(lanes, edge, near_skin, begin, end);                                                             \
  }
GRAINLAW_PASSES(float, mixed)
GRAINLAW_PASSES(double, full)
#undef GRAINLAW_PASSES
#undef GRAINLAW_BY_BITS

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainlaw::dem
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "model/error.hpp"

namespace grainlaw::dem {

HWY_EXPORT(write_rows_mixed);
HWY_EXPORT(write_rows_full);
HWY_EXPORT(kick_and_drift_mixed);
HWY_EXPORT(kick_and_drift_full);
HWY_EXPORT(force_and_kick_mixed);
HWY_EXPORT(force_and_kick_full);
HWY_EXPORT(pick_near_mixed);
HWY_EXPORT(pick_near_full);
HWY_EXPORT(find_near_on);

void write_rows(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(write_rows_mixed)(lanes, step, begin, end);
}
void write_rows(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(write_rows_full)(lanes, step, begin, end);
}
Drifted kick_and_drift(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(kick_and_drift_mixed)(lanes, step, begin, end);
}
Drifted kick_and_drift(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(kick_and_drift_full)(lanes, step, begin, end);
}
LaneSums force_and_kick(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(force_and_kick_mixed)(lanes, step, begin, end);
}
LaneSums force_and_kick(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(force_and_kick_full)(lanes, step, begin, end);
}
void pick_near(Lanes<float>& lanes, const std::array<double, 3>& edge, double near_skin, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(pick_near_mixed)(lanes, edge, near_skin, begin, end);
}
void pick_near(Lanes<double>& lanes, const std::array<double, 3>& edge, double near_skin, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(pick_near_full)(lanes, edge, near_skin, begin, end);
}
std::size_t find_near(const SearchField& field, std::size_t i, std::span<const SearchRange> ranges, std::uint32_t* found) {
  return HWY_DYNAMIC_DISPATCH(find_near_on)(field, i, ranges, found);
}

std::vector<std::string> vector_targets() {
  hwy::SetSupportedTargetsForTest(0);
  std::vector<std::string> names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
  return names;
}

void use_vector_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  std::int64_t chosen = name.empty() ? hwy::SupportedTargets() : 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (name == hwy::TargetName(target)) chosen = target;
  }
  if (chosen == 0) throw InvalidInput("this machine has no vector instructions called " + name);
  hwy::SetSupportedTargetsForTest(name.empty() ? 0 : chosen);
  hwy::GetChosenTarget().Update(chosen);
}

}  // namespace grainlaw::dem
#endif
