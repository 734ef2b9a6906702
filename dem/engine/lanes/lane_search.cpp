#include "dem/engine/lanes/lane_search.hpp"

#include <algorithm>
#include <bit>
#include <limits>

// The code between foreach_target.h and HWY_ONCE is compiled once for each kind of vector instructions.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)  // nothing of theirs is used
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem/engine/lanes/lane_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "dem/engine/lanes/lane_dispatch.hpp"
#include "dem/engine/lanes/lane_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainlaw::dem {
namespace HWY_NAMESPACE {
namespace {

template <class Real>
double choose_near_skins_on(Lanes<Real>& lanes, const std::array<double, 3>& edge, const NearSkins& skins, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const hn::RebindToSigned<Tag<Real>> di;
  using V = hn::Vec<Tag<Real>>;
  const auto set = [&](double x) { return hn::Set(d, static_cast<Real>(x)); };
  const auto length = [&](V x, V y, V z) { return hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)))); };
  const Edge<Tag<Real>, false> ex(d, edge[0]), ey(d, edge[1]), ez(d, edge[2]);
  const V duration = set(skins.duration), durations = set(skins.since > 0 ? skins.duration / skins.since : 0), memory = set(skins.memory),
          least = set(skins.least), most = set(skins.most), listed = set(skins.listed);
  V farthest = hn::Zero(d);
  for (std::size_t g = begin; g < end; ++g) {
    SphereGroup<Real>& own = lanes.group[g];
    const PlacedGroup<Real>& now = lanes.placed[g];
    const ListedGroup<Real>& then = lanes.listed[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto at = [&](const Real* x) { return hn::Load(d, x + o); };
      const auto since = [&](const FixedPoint<Real>* x, const FixedPoint<Real>* x_0) { return hn::Sub(hn::Load(di, x + o), hn::Load(di, x_0 + o)); };
      const V speed = length(at(own.vx), at(own.vy), at(own.vz));
      const V moved = length(ex(d, since(now.x, own.near_x)), ey(d, since(now.y, own.near_y)), ez(d, since(now.z, own.near_z)));
      const V moved_in_all = length(ex(d, since(now.x, then.x)), ey(d, since(now.y, then.y)), ez(d, since(now.z, then.z)));
      const V wanted = hn::Max(hn::Max(hn::Mul(duration, speed), hn::Mul(durations, moved)), hn::Max(hn::Mul(memory, at(own.near_skin)), least));
      const V skin = hn::Max(hn::Min(hn::Min(wanted, most), hn::Sub(listed, moved_in_all)), hn::Zero(d));
      hn::Store(skin, d, own.near_skin + o);
      farthest = hn::Max(farthest, hn::Add(skin, moved_in_all));
    }
    for (std::size_t l = 0; l < kLanes; ++l) lanes.row[g * kLanes + l].reach = now.radius[l] + own.near_skin[l];
  }
  return static_cast<double>(hn::GetLane(hn::MaxOfLanes(d, farthest)));
}

template <class Real>
void pick_near_on(Lanes<Real>& lanes, const std::array<double, 3>& edge, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const hn::RebindToSigned<Tag<Real>> di;
  using V = hn::Vec<Tag<Real>>;
  const Edge<Tag<Real>, false> ex(d, edge[0]), ey(d, edge[1]), ez(d, edge[2]);
  const Real* rows = reinterpret_cast<const Real*>(lanes.row.data());
  const auto nobody = static_cast<std::uint32_t>((lanes.row.size() - 1) * sizeof(SphereRow<Real>));
  std::size_t next = lanes.first_tier[begin];
  for (std::size_t g = begin; g < end; ++g) {
    fetch_frontier(lanes, g);
    SphereGroup<Real>& own = lanes.group[g];
    const PlacedGroup<Real>& now = lanes.placed[g];
    std::uint32_t count[kLanes] = {};
    Tier* picked = lanes.near_tier.data() + next;
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto x = hn::Load(di, now.x + o), y = hn::Load(di, now.y + o), z = hn::Load(di, now.z + o);
      hn::Store(x, di, own.near_x + o);
      hn::Store(y, di, own.near_y + o);
      hn::Store(z, di, own.near_z + o);
      const V reach = hn::Add(hn::Load(d, now.radius + o), hn::Load(d, own.near_skin + o));
      for (std::size_t tier = lanes.first_tier[g]; tier < lanes.first_tier[g + 1]; ++tier) {
        const std::uint32_t* row = lanes.tier[tier].row + o;
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
    lanes.near_first[g] = next;
    lanes.near_count[g] = longest;
    next += longest;
  }
}

FoundNear find_near_on(const SearchField& field, std::size_t i, std::span<const SearchRange> ranges, float narrower,
                       std::uint32_t* found) {
  const Tag<float> d;
  const hn::RebindToSigned<Tag<float>> di;
  const auto x = hn::Set(di, field.x[i]), y = hn::Set(di, field.y[i]), z = hn::Set(di, field.z[i]);
  const auto reach = hn::Set(d, field.reach[i]), less = hn::Set(d, narrower);
  const auto ex = hn::Set(d, field.edge[0]), ey = hn::Set(d, field.edge[1]), ez = hn::Set(d, field.edge[2]);
  const auto self = hn::Set(di, static_cast<std::int32_t>(i)), lane = hn::Iota(di, 0);
  FoundNear count;
  for (const SearchRange& range : ranges) {
    const auto end = hn::Set(di, static_cast<std::int32_t>(range.end));
    for (std::size_t p = range.begin; p < range.end; p += hn::Lanes(d)) {
      const auto dx = hn::Mul(hn::ConvertTo(d, hn::Sub(x, hn::LoadU(di, field.x + p))), ex),
                 dy = hn::Mul(hn::ConvertTo(d, hn::Sub(y, hn::LoadU(di, field.y + p))), ey),
                 dz = hn::Mul(hn::ConvertTo(d, hn::Sub(z, hn::LoadU(di, field.z + p))), ez);
      // not fused: one list everywhere
      const auto d2 = hn::Add(hn::Mul(dz, dz), hn::Add(hn::Mul(dy, dy), hn::Mul(dx, dx)));
      const auto both = hn::Add(reach, hn::LoadU(d, field.reach + p)), narrow = hn::Sub(both, less);
      const auto index = hn::Add(lane, hn::Set(di, static_cast<std::int32_t>(p)));
      auto listed = hn::RebindMask(di, hn::Lt(d2, hn::Mul(both, both)));
      listed = hn::And(listed, hn::And(hn::Ne(index, self), hn::Lt(index, end)));
      if (hn::Lanes(d) < 16 && hn::AllFalse(di, listed)) continue;  // of sixteen some mostly are: not worth a branch
      hn::StoreU(hn::Compress(index, listed), di, reinterpret_cast<std::int32_t*>(found + count.listed));
      count.listed += hn::CountTrue(di, listed);
      count.near += hn::CountTrue(di, hn::And(listed, hn::RebindMask(di, hn::Lt(d2, hn::Mul(narrow, narrow)))));
    }
  }
  return count;
}

void order_by_key_on(std::int32_t* key, const std::uint32_t* value, std::size_t count, std::uint32_t* ordered) {
  const hn::RebindToSigned<Tag<float>> di;
  hn::StoreU(hn::Set(di, std::numeric_limits<std::int32_t>::max()), di, key + count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto own = hn::Set(di, key[k]);
    std::size_t smaller = 0;
    for (std::size_t o = 0; o < count; o += hn::Lanes(di)) smaller += hn::CountTrue(di, hn::Lt(hn::LoadU(di, key + o), own));
    ordered[smaller] = value[k];
  }
}

#define GRAINLAW_CALL(pass_on, ...) pass_on(__VA_ARGS__)
#define GRAINLAW_PASSES(PASS)                                                                           \
  PASS(double, choose_near_skins, ,                                                                     \
       (const std::array<double, 3>& edge, const NearSkins& skins, std::size_t begin, std::size_t end), \
       (edge, skins, begin, end))                                                                       \
  PASS(void, pick_near, , (const std::array<double, 3>& edge, std::size_t begin, std::size_t end), (edge, begin, end))
GRAINLAW_PASSES(GRAINLAW_PLAIN_PASS)

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainlaw::dem
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainlaw::dem {

GRAINLAW_PASSES(GRAINLAW_DISPATCHED_PASS)
HWY_EXPORT(find_near_on);
HWY_EXPORT(order_by_key_on);

FoundNear find_near(const SearchField& field, std::size_t i, std::span<const SearchRange> ranges, float narrower,
                    std::uint32_t* found) {
  return HWY_DYNAMIC_DISPATCH(find_near_on)(field, i, ranges, narrower, found);
}
void order_by_key(std::int32_t* key, const std::uint32_t* value, std::size_t count, std::uint32_t* ordered) {
  HWY_DYNAMIC_DISPATCH(order_by_key_on)(key, value, count, ordered);
}

}  // namespace grainlaw::dem
#endif
