#include "core/accel/kd_builder.h"
#include "core/accel/kd_merge.h"
#include "core/accel/traced_object.h"
#include "tests/stress/stress.h"
#include "tests/support/oracle.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

/// What a tree is built over: a mesh, or boxes.
struct Scene {
    std::string name;
    MeshPtr mesh;
    std::vector<Bounds3> bounds;
};

bool is_usable(const Bounds3& b) {
    return !b.empty() && is_finite(b.lo) && is_finite(b.hi);
}

Scene of_mesh(std::string name, MeshPtr mesh) {
    Scene scene{std::move(name), mesh, {}};
    for (const glm::uvec3& t : mesh->triangles) {
        Bounds3 bounds;
        for (int corner = 0; corner < 3; ++corner) {
            const Vec3& p = mesh->positions[t[corner]];
            if (is_finite(p)) bounds.extend(p);
        }
        const bool finite =
            is_finite(mesh->positions[t.x]) && is_finite(mesh->positions[t.y]) && is_finite(mesh->positions[t.z]);
        scene.bounds.push_back(finite ? bounds : Bounds3());
    }
    return scene;
}

MeshPtr with_broken_triangles(const TriangleMesh& mesh, Random& random) {
    std::vector<Vec3> positions = mesh.positions;
    for (int i = 0; i < 3; ++i)
        positions[random.bits() % positions.size()][random.integer(0, 2)] = random.integer(0, 1) ? NAN : kInfinity;
    return make_mesh(std::move(positions), mesh.triangles);
}

/// Some of them flat, some equal, some within others.
Scene of_boxes(Random& random) {
    Scene scene{"boxes", nullptr, {}};
    const int count = random.integer(1, 200);
    for (int i = 0; i < count; ++i) {
        Vec3 lo = random.in_cube(), size = glm::abs(random.in_cube(log_uniform(random, 0.01f, 1)));
        if (random.integer(0, 3) == 0) size[random.integer(0, 2)] = 0;
        if (random.integer(0, 3) == 0) lo = glm::round(4.0f * lo) / 4.0f;
        scene.bounds.push_back({lo, lo + size});
        if (random.integer(0, 7) == 0) scene.bounds.push_back(scene.bounds.back());
    }
    return scene;
}

/// Ever smaller ones, each beside all that are smaller still: the deepest of trees.
Scene of_powers(Random& random) {
    Scene scene{"powers of two", nullptr, {}};
    const int count = random.integer(20, 120);
    for (int i = 0; i < count; ++i) scene.bounds.push_back({Vec3(std::ldexp(1.0f, -i)), Vec3(std::ldexp(1.25f, -i))});
    return scene;
}

Scene random_scene(std::uint64_t number, Random& random) {
    switch (number % 10) {
        case 0:
            return of_mesh("soup", make_soup(random.integer(1, 300), random));
        case 1:
            return of_mesh("ball", make_ball(random.integer(3, 9), 1, random.in_cube(), 0.2f, number));
        case 2:
            return of_mesh("ball far away", make_ball(random.integer(3, 9), 1, random.in_cube(1e6f), 0.2f, number));
        case 3:
            return of_mesh("flat grid", make_grid(random.integer(1, 12), 0));
        case 4:
            return of_mesh("grid", make_grid(random.integer(1, 12), 0.3f));
        case 5:
            return of_mesh("equal triangles",
                           make_mesh({random.in_cube(), random.in_cube(), random.in_cube()},
                                     std::vector<glm::uvec3>(1 + random.bits() % 100, glm::uvec3(0, 1, 2))));
        case 6:
            return of_mesh("broken soup", with_broken_triangles(*make_soup(random.integer(4, 200), random), random));
        case 7: {
            const MeshPtr soup = make_soup(random.integer(1, 200), random);
            std::vector<Vec3> positions = soup->positions;
            for (std::size_t i = 0; i < positions.size(); ++i) {
                // By the triangle, of which soup has one for three positions.
                const bool small = i / 3 % 4 == 0;
                positions[i] = small ? 1e-5f * positions[i] : glm::round(positions[i] * 8.0f) / 8.0f;
            }
            return of_mesh("lattice and cluster", make_mesh(std::move(positions), soup->triangles));
        }
        case 8:
            return of_powers(random);
        default:
            return of_boxes(random);
    }
}

/// One side of a plane across an axis.
struct Side {
    int axis;
    float plane;
    bool below;

    Real depth(const Vec3l& p) const { return below ? plane - p[axis] : p[axis] - plane; }
};

using Polygon = std::vector<Vec3l>;

Polygon triangle(const TriangleMesh& mesh, std::uint32_t primitive) {
    const glm::uvec3& t = mesh.triangles[primitive];
    return {Vec3l(mesh.positions[t.x]), Vec3l(mesh.positions[t.y]), Vec3l(mesh.positions[t.z])};
}

/// The part at least `margin` deep (Sutherland & Hodgman); also of polygons that are a line or a point.
Polygon clip(const Polygon& polygon, const Side& side, Real margin) {
    Polygon result;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3l &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const Real da = side.depth(a) - margin, db = side.depth(b) - margin;
        if (da >= 0) result.push_back(a);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) result.push_back(a + da / (da - db) * (b - a));
    }
    return result;
}

/// What a primitive has inside a cell, as the oracle follows it from the root down.
struct Piece {
    std::uint32_t primitive;
    Polygon polygon;  ///< Of a triangle, farther than the rounding of double from the planes around the cell.
    Bounds3 box;      ///< Else.
    Real margin = 0;

    bool enter(const Side& side) {
        if (!polygon.empty()) {
            polygon = clip(polygon, side, margin);
            return !polygon.empty();
        }
        if (!(side.below ? box.lo[side.axis] < side.plane : box.hi[side.axis] > side.plane)) return false;
        float& end = side.below ? box.hi[side.axis] : box.lo[side.axis];
        end = side.below ? std::min(end, side.plane) : std::max(end, side.plane);
        return true;
    }
};

/// In float, containing the polygon up to the rounding of double.
Bounds3 bounds_of(const Polygon& polygon) {
    Bounds3 bounds;
    for (const Vec3l& p : polygon) {
        const Bounds3 point = round_outward(Vec3d(p), Vec3d(p));
        bounds.extend(point);
    }
    return bounds;
}

Bounds3 intersection(const Bounds3& a, const Bounds3& b) {
    return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
}

struct Cell {
    Bounds3 bounds;
    std::vector<Side> path;  ///< From the root.
};

/// Half the surface area of a cell, or the sum of its sides where it has none.
double measure(const Bounds3& cell) {
    const Vec3d e = Vec3d(cell.hi) - Vec3d(cell.lo);
    const double area = e.x * e.y + e.y * e.z + e.z * e.x;
    return area > 0 ? area : e.x + e.y + e.z;
}

/// The cost of a cut by the surface area heuristic, in tests of a primitive (see find_sah_cut); infinite where the plane
/// does not lie within the cell. A box within the plane is on the side below.
double cost_of_cut(const Bounds3& cell, const std::vector<Bounds3>& boxes, int axis, float plane) {
    if (!(plane > cell.lo[axis] && plane < cell.hi[axis])) return INFINITY;
    double below = 0, above = 0;
    for (const Bounds3& box : boxes) {
        below += box.lo[axis] < plane || box.hi[axis] <= plane ? 1 : 0;
        above += box.hi[axis] > plane ? 1 : 0;
    }
    Bounds3 cell_below = cell, cell_above = cell;
    cell_below.hi[axis] = cell_above.lo[axis] = plane;
    const double tests = (measure(cell_below) * below + measure(cell_above) * above) / measure(cell);
    return (below == 0 || above == 0 ? 0.8 : 1.0) * (1 + tests);
}

/// Over the ends of all boxes where there are few, else at 32 equal parts of what they span. A flat box begins before its
/// plane.
double cheapest_cut(const Bounds3& cell, const std::vector<Bounds3>& boxes) {
    constexpr std::size_t kFew = 64;
    Bounds3 held;
    for (const Bounds3& box : boxes) held.extend(box);
    double cheapest = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float> planes{held.lo[axis], held.hi[axis]};
        for (const Bounds3& box : boxes) {
            const float lo = box.lo[axis], hi = box.hi[axis];
            if (boxes.size() <= kFew) planes.insert(planes.end(), {lo < hi ? lo : std::nextafter(lo, -INFINITY), hi});
        }
        for (int k = 1; k < 32 && boxes.size() > kFew; ++k)
            planes.push_back(glm::mix(held.lo[axis], held.hi[axis], static_cast<float>(k) / 32));
        for (const float plane : planes) cheapest = std::min(cheapest, cost_of_cut(cell, boxes, axis, plane));
    }
    return cheapest;
}

/// A node hands the references that cuts may add, a million at the root, down in proportion to what its children hold: so
/// deep an SAH leaf may have none left for the cut that it wants.
constexpr std::size_t kSharedDepth = 30;

/// One tree, held to an oracle that clips in long double and sorts instead of partitioning.
class TreeCheck {
public:
    TreeCheck(const Scene& scene, const KdBuildInput& input, const KdTree& tree, Outcome& outcome)
        : scene_(scene),
          input_(input),
          tree_(tree),
          outcome_(outcome),
          visited_(tree.nodes.size()),
          referenced_(tree.references.size()),
          leaves_of_(scene.bounds.size()) {}

    void run() {
        Cell root;
        std::vector<Piece> pieces;
        std::vector<std::uint32_t> owned;
        for (std::uint32_t i = 0; i < scene_.bounds.size(); ++i) {
            const Bounds3& box = scene_.bounds[i];
            if (!is_usable(box)) continue;
            root.bounds.extend(box);
            owned.push_back(i);
            const Vec3 reach = glm::max(glm::abs(box.lo), glm::abs(box.hi));
            pieces.push_back({i, scene_.mesh ? triangle(*scene_.mesh, i) : Polygon(), box,
                              0x1p-46L * std::max({reach.x, reach.y, reach.z, 0x1p-100f})});
        }
        expect(tree_.bounds.lo == root.bounds.lo && tree_.bounds.hi == root.bounds.hi, "the root's cell");
        walk(0, root, pieces, owned);
        expect(std::ranges::count(visited_, false) == 0, "each node stands in the tree");
        expect(std::ranges::count(referenced_, false) == 0, "each reference belongs to a leaf");
        for (std::uint32_t i = 0; i < scene_.bounds.size(); ++i) check_primitive(i);
    }

private:
    void expect(bool holds, const char* what) {
        outcome_.expect(holds, [&] {
            return fmt::format("{} of {} primitives, {}, leaf size {}: {}", scene_.name, scene_.bounds.size(),
                               input_.split == KdSplit::sah ? "sah" : "median", input_.leaf_size, what);
        });
    }

    void walk(std::uint32_t index, const Cell& cell, const std::vector<Piece>& pieces,
              std::vector<std::uint32_t> owned) {
        if (index >= tree_.nodes.size() || visited_[index] || cell.path.size() > kKdMaxDepth) {
            expect(false, "a tree, no deeper than the cap");
            return;
        }
        visited_[index] = true;
        const KdNode& node = tree_.nodes[index];
        if (node.is_leaf()) {
            check_leaf(node, cell, pieces, owned);
            return;
        }
        const int axis = node.axis();
        const float plane = node.split();
        expect(plane > cell.bounds.lo[axis] && plane < cell.bounds.hi[axis], "the children tile their parent");
        sort_by_center(owned, axis);
        const std::size_t middle = input_.split == KdSplit::median ? owned.size() / 2 : 0;
        if (input_.split == KdSplit::median)
            expect(owned.size() > 1 && center(owned[middle - 1], axis) <= plane && plane <= center(owned[middle], axis),
                   "at the median");
        for (const bool below : {true, false}) {
            const Side side{axis, plane, below};
            Cell child = cell;
            (below ? child.bounds.hi : child.bounds.lo)[axis] = plane;
            child.path.push_back(side);
            std::vector<Piece> inside = pieces;
            std::erase_if(inside, [&](Piece& piece) { return !piece.enter(side); });
            const auto half = owned.begin() + static_cast<std::ptrdiff_t>(middle);
            const std::uint32_t to = node.children() + (below ? 0 : 1);
            walk(to, child, inside, below ? std::vector(owned.begin(), half) : std::vector(half, owned.end()));
            expect(node.is_empty(below ? 0 : 1) == tree_.nodes[to].is_empty_leaf(), "a node knows its empty children");
        }
    }

    void check_leaf(const KdNode& leaf, const Cell& cell, const std::vector<Piece>& pieces,
                    const std::vector<std::uint32_t>& owned) {
        ++outcome_.cases;
        std::vector<std::uint32_t> references;
        for (std::uint32_t i = leaf.first(); i < leaf.first() + leaf.count(); ++i) {
            expect(i < referenced_.size() && !referenced_[i], "leaves share no references");
            if (i >= referenced_.size()) return;
            referenced_[i] = true;
            references.push_back(tree_.references[i]);
            leaves_of_[references.back()].push_back(cell.bounds);
        }
        std::ranges::sort(references);
        expect(std::ranges::adjacent_find(references) == references.end(), "a leaf refers to a primitive once");
        const auto holds = [&](std::uint32_t primitive) { return std::ranges::binary_search(references, primitive); };
        for (const Piece& piece : pieces)
            expect(holds(piece.primitive), "a leaf refers to each primitive that its cell meets");
        if (cell.path.size() == kKdMaxDepth) return;
        const auto limit = static_cast<std::size_t>(input_.leaf_size);
        if (input_.split == KdSplit::sah) {
            if (references.size() <= limit || cell.path.size() > kSharedDepth) return;
            const double saved =
                static_cast<double>(references.size()) / cheapest_cut(cell.bounds, boxes(references, cell));
            outcome_.measure(saved);
            expect(saved <= 1.001, "a leaf above the limit that a cut would make cheaper");
        } else {
            for (const std::uint32_t i : owned) expect(holds(i), "a leaf refers to what it owns");
            std::vector<std::uint32_t> inside;
            for (const Piece& piece : pieces) inside.push_back(piece.primitive);
            expect(owned.size() <= limit || !has_median(owned, boxes(inside, cell), cell.bounds),
                   "a leaf above the limit that has a median");
        }
    }

    /// What the builder knows of primitives in a cell: bounds of the parts on this side of each plane on the way, cut with
    /// each other.
    std::vector<Bounds3> boxes(const std::vector<std::uint32_t>& primitives, const Cell& cell) const {
        std::vector<Bounds3> boxes;
        for (const std::uint32_t i : primitives) {
            Bounds3 box = intersection(scene_.bounds[i], cell.bounds);
            for (const Side& side : cell.path) {
                if (scene_.mesh) box = intersection(box, bounds_of(clip(triangle(*scene_.mesh, i), side, 0)));
            }
            boxes.push_back(box);
        }
        return boxes;
    }

    float center(std::uint32_t primitive, int axis) const { return scene_.bounds[primitive].center()[axis]; }

    void sort_by_center(std::vector<std::uint32_t>& primitives, int axis) const {
        std::ranges::sort(primitives, [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(center(a, axis), a) < std::pair(center(b, axis), b);
        });
    }

    /// Whether the plane through the median of some axis lies within the cell and leaves a primitive on one side alone.
    bool has_median(std::vector<std::uint32_t> owned, const std::vector<Bounds3>& boxes, const Bounds3& cell) const {
        for (int axis = 0; axis < 3 && owned.size() > 1; ++axis) {
            sort_by_center(owned, axis);
            const std::size_t middle = owned.size() / 2;
            const float plane = 0.5f * center(owned[middle - 1], axis) + 0.5f * center(owned[middle], axis);
            const bool inside = plane > cell.lo[axis] && plane < cell.hi[axis];
            const auto on_both = [&](const Bounds3& box) { return box.lo[axis] < plane && box.hi[axis] > plane; };
            if (inside && !std::ranges::all_of(boxes, on_both)) return true;
        }
        return false;
    }

    /// A corner of a primitive lies in a leaf that refers to it, also where it lies within planes.
    void check_primitive(std::uint32_t primitive) {
        const Bounds3& box = scene_.bounds[primitive];
        expect(leaves_of_[primitive].empty() == !is_usable(box), "each primitive is in a leaf, if rays can meet it");
        if (!is_usable(box)) return;
        for (int i = 0; i < (scene_.mesh ? 3 : 8); ++i) {
            const Vec3 corner = scene_.mesh ? scene_.mesh->positions[scene_.mesh->triangles[primitive][i]]
                                            : Vec3((i & 1 ? box.lo : box.hi).x, (i & 2 ? box.lo : box.hi).y,
                                                   (i & 4 ? box.lo : box.hi).z);
            const auto contains = [&](const Bounds3& cell) { return cell.contains(corner); };
            expect(std::ranges::any_of(leaves_of_[primitive], contains), "each corner lies in a leaf of its primitive");
        }
    }

    const Scene& scene_;
    const KdBuildInput& input_;
    const KdTree& tree_;
    Outcome& outcome_;
    std::vector<bool> visited_, referenced_;
    std::vector<std::vector<Bounds3>> leaves_of_;  ///< Cells of the leaves that refer to a primitive.
};

/// A median leaf holds at most leaf_size primitives of its own unless no axis has a median that tells them apart; an SAH
/// leaf at most leaf_size references unless no cut has a lower expected cost than the leaf.
/// Figure: cost of an SAH leaf above the limit over that of its best cut.
Outcome invariants(double scale) {
    return for_batches(
        scaled(1000, scale, 20), 14, 1, [](Random& random, std::uint64_t number, std::uint64_t, Outcome& outcome) {
            const Scene scene = random_scene(number, random);
            outcome.cases -= 1;
            for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
                KdTree finest;
                for (const int leaf_size : {1, 2, 3, 4, 8, 16, 64, static_cast<int>(scene.bounds.size())}) {
                    const KdBuildInput input{
                        .bounds = scene.bounds, .mesh = scene.mesh.get(), .split = split, .leaf_size = leaf_size};
                    BuildControl control;
                    const KdTree built = *build_kd_tree(input, control);
                    TreeCheck(scene, input, built, outcome).run();
                    if (leaf_size == 1) finest = built;
                    TreeCheck(scene, input, *merge_leaves(finest, split, leaf_size, control), outcome).run();
                }
            }
        });
}

}  // namespace

std::vector<StressTest> kd_invariant_tests() {
    return {{14, "invariants of the tree, 8 leaf sizes, built and raised", "cost over best cut", 1.001, invariants}};
}

}  // namespace rayuela::stress
