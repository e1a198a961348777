#include "core/lights/light_builder.h"

#include "core/accel/traced_object.h"
#include "core/materials/bsdf.h"
#include "core/math/sampler.h"
#include "core/math/sampling.h"

namespace rayuela {
namespace {

class Builder {
public:
    Builder(const GeometryInstance& instance, const Material& material, std::vector<AreaLight>& lights)
        : to_world_(instance.to_world),
          mirrored_(glm::determinant(glm::dmat3(to_world_.linear)) < 0),
          material_(emits_evenly(material) ? nullptr : std::make_shared<const Material>(material)),
          two_sided_(emits_two_sided(material)),
          radiance_(emitted(material, Vec2(0), true)),
          lights_(lights) {}

    void operator()(const Sphere& sphere) {
        const std::optional<SphereD> world = world_sphere(sphere, to_world_);
        if (!world) return;
        AreaLight light = make();
        light.kind = AreaLight::Kind::sphere;
        light.origin = Vec3(world->center);
        light.size = static_cast<float>(world->radius);
        if (material_) {
            EmissionTexture texture{material_};
            texture.sphere_to_local = glm::transpose(to_world_.linear);
            set_texture(light, std::move(texture), 256, sample_uniform_sphere);
        }
        lights_.push_back(std::move(light));
    }

    void operator()(const Plane&) {}

    void operator()(const Box& box) {
        for (int face = 0; face < 6; ++face) {
            const int axis = face / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
            Vec3 corner = box.min, along_a(0), along_b(0);
            if (face % 2 == 1) corner[axis] = box.max[axis];
            along_a[a] = box.max[a] - box.min[a];
            along_b[b] = box.max[b] - box.min[b];
            // along_a x along_b points along +axis: outward only on the far side.
            flat(AreaLight::Kind::parallelogram, to_world_.point(corner), to_world_.vector(along_a),
                 to_world_.vector(along_b), face % 2 == 0);
        }
    }

    void operator()(const Triangle& triangle) {
        const TriangleCorners c = world_triangle(triangle, to_world_);
        flat(AreaLight::Kind::triangle, c[0], c[1] - c[0], c[2] - c[0], false);
    }

    void operator()(const Quad& quad) {
        const QuadCorners c = world_quad(quad, to_world_);
        flat(AreaLight::Kind::parallelogram, c[0], c[1] - c[0], c[3] - c[0], false);
    }

    void operator()(const std::shared_ptr<const TriangleMesh>& mesh) {
        const auto uvs = material_ ? uvs_of(mesh) : nullptr;
        for (const glm::uvec3& t : mesh->triangles) {
            const Vec3 a = to_world_.point(mesh->positions[t.x]);
            const Vec3 b = to_world_.point(mesh->positions[t.y]);
            const Vec3 c = to_world_.point(mesh->positions[t.z]);
            EmissionTexture texture{material_};
            if (uvs) {
                texture.uv_origin = (*uvs)[t.x];
                texture.uv_u = (*uvs)[t.y] - (*uvs)[t.x];
                texture.uv_v = (*uvs)[t.z] - (*uvs)[t.x];
            }
            flat(AreaLight::Kind::triangle, a, b - a, c - a, false, texture);
        }
    }

private:
    AreaLight make() const {
        AreaLight light;
        light.two_sided = two_sided_;
        light.radiance = radiance_;
        return light;
    }

    void flat(AreaLight::Kind kind, const Vec3& corner, const Vec3& u, const Vec3& v, bool inverted) {
        flat(kind, corner, u, v, inverted, EmissionTexture{material_});
    }

    void flat(AreaLight::Kind kind, const Vec3& corner, const Vec3& u, const Vec3& v, bool inverted,
              const EmissionTexture& texture) {
        AreaLight light = make();
        light.place(kind, corner, u, v, inverted != mirrored_);
        if (material_) {
            const bool triangle = kind == AreaLight::Kind::triangle;
            set_texture(light, texture, triangle ? 16 : 256,
                        [=](const Vec2& x) { return triangle ? sample_uniform_triangle(x) : x; });
        }
        lights_.push_back(std::move(light));
    }

    /// Lets the emission vary and estimates its mean; `position` maps [0, 1)^2 evenly onto the light.
    template <typename Position>
    void set_texture(AreaLight& light, EmissionTexture texture, int samples, const Position& position) const {
        light.texture = std::make_shared<const EmissionTexture>(std::move(texture));
        Vec3d sum(0);
        for (int i = 0; i < samples; ++i) {
            const Vec2 u((static_cast<float>(i) + 0.5f) / static_cast<float>(samples),
                         to_unit_float(reverse_bits(static_cast<std::uint32_t>(i))));
            sum += Vec3d(light.radiance_at(position(u)));
        }
        light.radiance = Color(sum / static_cast<double>(samples));
    }

    const Affine& to_world_;
    bool mirrored_;
    std::shared_ptr<const Material> material_;  ///< Null where the emission does not vary.
    bool two_sided_;
    Color radiance_;
    std::vector<AreaLight>& lights_;
};

}  // namespace

void append_lights(const GeometryInstance& instance, const Material& material, std::vector<AreaLight>& lights) {
    if (is_emissive(material)) std::visit(Builder(instance, material, lights), instance.shape);
}

}  // namespace rayuela
