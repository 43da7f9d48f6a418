// Walks pieces of an image's rays, one per lane. Included once for each instruction set (see Highway's
// foreach_target.h, which comes before).
#if defined(OCTOSKIN_WALKERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOSKIN_WALKERS_INL
#undef OCTOSKIN_WALKERS_INL
#else
#define OCTOSKIN_WALKERS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "host/core/traversal/lanes-inl.hpp"
#include "host/core/traversal/ray_pieces.hpp"

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {

/// Rays along one axis, one per lane: see `Ray`. `faces`: from origin to end, signed.
struct Crossings {
    Double next;
    Double step;
    Double stride;
    Double faces;
};

/// Same as plan_axis(). `length_m` and the quotient are in single precision.
HWY_INLINE Crossings plan(const Walk& walk, const WalkAxis& axis, Float end, Float length_m) {
    const Doubles d;
    const Floats f;
    // If two points are so close that their distance underflows: no direction and no step.
    const Float quotient = hn::Div(hn::Sub(end, hn::Set(f, axis.origin)), length_m);
    const Double direction = hn::PromoteTo(d, hn::IfThenElseZero(hn::Gt(length_m, hn::Zero(f)), quotient));
    const Mask is_up = hn::Gt(direction, hn::Zero(d));
    const Mask is_moving = hn::Or(is_up, hn::Lt(direction, hn::Zero(d)));
    const Double never = hn::Set(d, std::numeric_limits<double>::max());
    const Double resolution = hn::Set(d, walk.resolution_m);
    const Double centre = hn::Mul(hn::Set(d, axis.floored_origin + 0.5), resolution);
    const Double half = hn::Set(d, axis.half_edge_m);
    const Double stride = hn::Set(d, axis.stride);
    const Double border = hn::Add(centre, hn::IfThenElse(is_up, half, hn::Neg(half)));
    const Double to_border = hn::Sub(border, hn::Set(d, static_cast<double>(axis.origin)));
    const Double end_floored = hn::Floor(hn::Mul(hn::Set(d, walk.voxels_per_m), hn::PromoteTo(d, end)));
    return {hn::IfThenElse(is_moving, hn::Div(to_border, direction), never),
            hn::IfThenElse(is_moving, hn::Div(resolution, hn::Abs(direction)), never),
            hn::IfThenElse(is_up, stride, hn::IfThenElseZero(is_moving, hn::Neg(stride))),
            hn::Sub(end_floored, hn::Set(d, axis.floored_origin))};
}

/// Skips the faces that are crossed before `from`, unless that is the origin. True where it is uncertain
/// which faces those are.
HWY_INLINE Mask begin_at(Crossings& axis, Double from, Double error, Double& index) {
    const Doubles d;
    const Mask is_later = hn::Gt(from, hn::Zero(d));
    const Double behind = hn::Ceil(hn::Div(hn::Sub(from, axis.next), axis.step));
    const Double faces = hn::IfThenElseZero(is_later, hn::Max(behind, hn::Zero(d)));
    axis.next = hn::Add(axis.next, hn::Mul(faces, axis.step));
    index = hn::Add(index, hn::Mul(faces, axis.stride));
    const Double since_last = hn::Sub(from, hn::Sub(axis.next, axis.step));
    return hn::And(is_later, hn::Lt(hn::Min(hn::Sub(axis.next, from), since_last), error));
}

/// Walks one piece per lane. Calls visit(index, mask of the lanes that are there) for each voxel.
template <class Visit>
class Walkers {
  public:
    /// `count`: number of pieces, at least one. A lane without a piece does not walk.
    HWY_NOINLINE Walkers(const Walk& walk, const RayPiece* pieces, std::size_t count, const Visit& visit);

    [[nodiscard]] HWY_INLINE bool have_ended() const { return hn::AllFalse(Doubles(), is_walking_); }
    /// True where the order of two faces is uncertain.
    [[nodiscard]] HWY_INLINE Mask is_undecided() const { return is_undecided_; }
    /// Crosses one face per lane and visits the voxel behind it.
    HWY_INLINE void step();

  private:
    Visit visit_;
    Crossings x_, y_, z_;
    Double nearest_;  ///< distance to the nearest next face
    Double index_;
    Double last_;
    Double to_;
    Double error_;
    Double beyond_;         ///< distance at which the walk has certainly passed the end
    Double nearly_beyond_;  ///< distance at which it has possibly passed the end
    Mask is_walking_;
    Mask is_undecided_;
};

// Not inlined: Clang with sanitizers takes minutes to compile it together with its caller.
template <class Visit>
HWY_NOINLINE Walkers<Visit>::Walkers(const Walk& walk, const RayPiece* pieces, std::size_t count,
                                     const Visit& visit)
    : visit_(visit) {
    const Doubles d;
    const Floats f;
    const Ints i;
    HWY_ALIGN std::array<std::int32_t, hn::MaxLanes(Doubles())> pixels;
    HWY_ALIGN std::array<float, hn::MaxLanes(Doubles())> froms;
    HWY_ALIGN std::array<float, hn::MaxLanes(Doubles())> tos;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
        const RayPiece& piece = pieces[std::min(lane, count - 1)];
        pixels[lane] = static_cast<std::int32_t>(piece.pixel);
        froms[lane] = piece.from_m;
        tos[lane] = piece.to_m;
    }
    const auto pixel = hn::Load(i, pixels.data());
    const Float end_x = hn::GatherIndex(f, walk.axes[0].end, pixel);
    const Float end_y = hn::GatherIndex(f, walk.axes[1].end, pixel);
    const Float end_z = hn::GatherIndex(f, walk.axes[2].end, pixel);
    const Float x = hn::Sub(end_x, hn::Set(f, walk.axes[0].origin));
    const Float y = hn::Sub(end_y, hn::Set(f, walk.axes[1].origin));
    const Float z = hn::Sub(end_z, hn::Set(f, walk.axes[2].origin));
    const Float length_f = hn::DemoteTo(f, length_of(x, y, z));
    const Double length = hn::PromoteTo(d, length_f);
    x_ = plan(walk, walk.axes[0], end_x, length_f);
    y_ = plan(walk, walk.axes[1], end_y, length_f);
    z_ = plan(walk, walk.axes[2], end_z, length_f);

    index_ = hn::Set(d, walk.first);
    last_ = hn::Add(index_, hn::Add(hn::Mul(x_.faces, hn::Set(d, walk.axes[0].stride)),
                                    hn::Add(hn::Mul(y_.faces, hn::Set(d, walk.axes[1].stride)),
                                            hn::Mul(z_.faces, hn::Set(d, walk.axes[2].stride)))));
    // A pixel without a ray has its end in the origin's voxel, as has a ray that passes no voxel.
    is_walking_ = hn::And(hn::Ne(index_, last_), hn::FirstN(d, count));

    const Double per_depth = hn::Div(length, hn::PromoteTo(d, hn::GatherIndex(f, walk.reach_m, pixel)));
    const Double from = hn::Mul(hn::PromoteTo(d, hn::Load(f, froms.data())), per_depth);
    to_ = hn::Mul(hn::PromoteTo(d, hn::Load(f, tos.data())), per_depth);
    const Mask is_whole = hn::Le(from, hn::Zero(d));
    error_ = hn::IfThenZeroElse(is_whole, hn::Set(d, walk.error_m));
    is_undecided_ = begin_at(x_, from, error_, index_);
    is_undecided_ = hn::Or(is_undecided_, begin_at(y_, from, error_, index_));
    is_undecided_ = hn::Or(is_undecided_, begin_at(z_, from, error_, index_));
    beyond_ = hn::Add(length, error_);
    nearly_beyond_ = hn::Sub(length, error_);
    nearest_ = hn::Min(hn::Min(x_.next, y_.next), z_.next);
    // OctoMap leaves out a voxel that is entered this late.
    is_undecided_ = hn::Or(is_undecided_, hn::AndNot(is_whole, hn::Gt(nearest_, nearly_beyond_)));
    is_walking_ = hn::And(is_walking_, hn::Ne(index_, last_));
    is_undecided_ = hn::And(is_undecided_, is_walking_);
    is_walking_ = hn::AndNot(is_undecided_, is_walking_);
    visit_(index_, is_walking_);
    is_walking_ = hn::And(is_walking_, hn::Le(nearest_, to_));
}

template <class Visit>
HWY_INLINE void Walkers<Visit>::step() {
    // Same as walk_ray(): on a tie z precedes y and y precedes x.
    const Mask x_before_y = hn::Lt(x_.next, y_.next);
    const Double nearer = hn::Min(x_.next, y_.next);
    const Mask z_is_later = hn::Lt(nearer, z_.next);
    const Mask is_z = hn::AndNot(z_is_later, is_walking_);
    const Mask is_x = hn::And(is_walking_, hn::And(z_is_later, x_before_y));
    const Mask is_y = hn::AndNot(x_before_y, hn::And(is_walking_, z_is_later));
    const Double second = hn::Max(hn::Min(hn::Max(x_.next, y_.next), z_.next), nearer);
    const Mask is_tie = hn::Lt(hn::Sub(second, nearest_), error_);
    x_.next = hn::IfThenElse(is_x, hn::Add(x_.next, x_.step), x_.next);
    y_.next = hn::IfThenElse(is_y, hn::Add(y_.next, y_.step), y_.next);
    z_.next = hn::IfThenElse(is_z, hn::Add(z_.next, z_.step), z_.next);
    const Double stride = hn::IfThenElse(is_z, z_.stride, hn::IfThenElse(x_before_y, x_.stride, y_.stride));
    index_ = hn::Add(index_, stride);
    nearest_ = hn::Min(hn::Min(x_.next, y_.next), z_.next);
    is_walking_ = hn::And(is_walking_, hn::Ne(index_, last_));
    const Mask is_past = hn::Gt(nearest_, beyond_);
    const Mask is_perhaps_past = hn::Gt(nearest_, nearly_beyond_);
    const Mask is_doubtful = hn::And(is_walking_, hn::Or(is_tie, hn::AndNot(is_past, is_perhaps_past)));
    is_undecided_ = hn::Or(is_undecided_, is_doubtful);
    is_walking_ = hn::AndNot(hn::Or(is_past, is_doubtful), is_walking_);
    visit_(index_, is_walking_);
    is_walking_ = hn::And(is_walking_, hn::Le(nearest_, to_));
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
