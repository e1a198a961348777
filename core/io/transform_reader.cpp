#include "core/io/json_reader.h"

#include <cmath>

namespace rayuela {

namespace {

/// {"axis": [x, y, z], "degrees": d}
Quat read_turn(const Json& json, const std::string& place, ProblemList& problems) {
    JsonObject turn(json, place, problems);
    const Json* axis_json = turn.take("axis");
    const Json* degrees_json = turn.take("degrees");
    turn.finish();
    if (!axis_json || !degrees_json) {
        problems.add(place, "needs an axis and degrees");
        return Transform{}.rotate;
    }
    const Vec3d axis = read_vec3(*axis_json, turn.place("axis"), problems).value_or(Vec3(1));
    const double degrees = read_float(*degrees_json, turn.place("degrees"), problems).value_or(0);
    const double length = glm::length(axis);
    if (!(length > 0) || !std::isfinite(length) || !std::isfinite(degrees)) {
        problems.add(place, "must be finite, with an axis other than zero");
        return Transform{}.rotate;
    }
    return Quat(glm::angleAxis(glm::radians(degrees), axis / length));
}

/// [x, y, z, w]
Quat read_quaternion(const Json& json, const std::string& place, ProblemList& problems) {
    const auto numbers = read_floats<4>(json, place, problems);
    if (!numbers) return Transform{}.rotate;
    const auto [x, y, z, w] = *numbers;
    const glm::dquat rotation(w, x, y, z);
    const double length = glm::length(rotation);
    if (!(length > 0) || !std::isfinite(length)) {
        problems.add(place, "must be a quaternion other than zero");
        return Transform{}.rotate;
    }
    // Unit within rounding stays as it is, so that saving and loading changes nothing.
    return std::abs(length - 1) < 1e-6 ? Quat(w, x, y, z) : Quat(rotation / length);
}

Vec3 read_scale(const Json& json, const std::string& place, ProblemList& problems) {
    if (const double* uniform = json.get<double>()) return Vec3(static_cast<float>(*uniform));
    return read_vec3(json, place, problems).value_or(Vec3(1));
}

}  // namespace

Transform read_transform(const Json& json, const Shape& shape, const std::string& place, ProblemList& problems) {
    const std::size_t before = problems.problems.size();
    Transform result;
    JsonObject object(json, place, problems);
    const Json* translate = object.take("translate");
    const Json* rotate = object.take("rotate");
    const Json* scale = object.take("scale");
    const Json* matrix = object.take("matrix");
    object.finish();
    if (translate) result.translate = read_vec3(*translate, object.place("translate"), problems).value_or(Vec3(0));
    if (rotate) {
        const auto read = rotate->get<Json::Object>() ? read_turn : read_quaternion;
        result.rotate = read(*rotate, object.place("rotate"), problems);
    }
    if (scale) result.scale = read_scale(*scale, object.place("scale"), problems);
    if (matrix) {
        if (translate || rotate || scale) {
            problems.add(object.place("matrix"), "stands instead of translate, rotate and scale, not beside them");
        }
        Mat4 values(1);
        if (const auto numbers = read_floats<16>(*matrix, object.place("matrix"), problems)) {
            for (int i = 0; i < 16; ++i) values[i / 4][i % 4] = (*numbers)[static_cast<std::size_t>(i)];
        }
        result.matrix = values;
    }
    if (problems.problems.size() == before) problems.add(check_transform(result, shape, place));
    return result;
}

}  // namespace rayuela
