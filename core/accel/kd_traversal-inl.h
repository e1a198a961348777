// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_KD_TRAVERSAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_KD_TRAVERSAL_INL_H_
#undef RAYUELA_CORE_ACCEL_KD_TRAVERSAL_INL_H_
#else
#define RAYUELA_CORE_ACCEL_KD_TRAVERSAL_INL_H_
#endif

#include "core/accel/kd_ray.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Visits the leaves that a ray may pass, near ones first: `bool visit(const KdNode& leaf)`, false to stop. `closest()` is
/// the t of the closest hit so far; what begins behind it is left out. Children overlap by the pads of KdRay.
template <typename Closest, typename Visit>
HWY_INLINE void traverse(const KdTree& tree, const KdRay& ray, const Closest& closest, const Visit& visit) {
    struct Entry {
        const KdNode* node;
        float begin, end;
    };
    Entry stack[kKdMaxDepth + 1];
    int size = 0;
    const KdNode* const nodes = tree.nodes.data();
    const KdNode* node = nodes;
    float begin = ray.begin, end = ray.end;
    if (begin > end) return;
    while (true) {
        while (!node->is_leaf()) {
            const auto axis = static_cast<std::size_t>(node->axis());
            const float leave = (node->split() - ray.leave[axis]) * ray.inverse[axis];
            const float enter = (node->split() - ray.enter[axis]) * ray.inverse[axis];
            const KdNode* const children = nodes + node->children();
            const KdNode* const near = children + ray.flip[axis];
            const KdNode* const far = children + (1 - ray.flip[axis]);
            if (enter > end) {
                node = near;
            } else if (leave < begin) {
                node = far;
            } else {
                stack[size++] = {far, enter > begin ? enter : begin, end};
                node = near;
                end = leave < end ? leave : end;
            }
        }
        if (!visit(*node)) return;
        const float limit = closest() * ray.t_scale;
        do {
            if (size == 0) return;
            --size;
        } while (stack[size].begin > limit);
        node = stack[size].node;
        begin = stack[size].begin;
        end = stack[size].end < limit ? stack[size].end : limit;
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
