#pragma once

#include "core/io/json.h"
#include "core/scene/validate.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rayuela {

/// What is wrong with a file, as it is found.
class ProblemList {
public:
    explicit ProblemList(std::string file) : file_(std::move(file)) {}

    void add(std::string place, std::string cause) { problems.push_back({file_, std::move(place), std::move(cause)}); }
    void add(Problems more) {
        for (Problem& problem : more) add(std::move(problem.place), std::move(problem.cause));
    }

    Problems problems;

private:
    std::string file_;
};

/// An object of a file whose members are taken one by one; what nobody took is unknown and told by `finish`.
class JsonObject {
public:
    /// A value that is no object is told and then read as an empty one.
    JsonObject(const Json& json, std::string place, ProblemList& problems);

    /// Null where the file has no such member.
    const Json* take(std::string_view key);
    /// Takes a member of that type; null, and told, where it is of another.
    template <typename T>
    const T* take_as(std::string_view key, std::string_view expected) {
        const Json* json = take(key);
        if (!json) return nullptr;
        const T* value = json->get<T>();
        if (!value) wrong_type(place(key), expected, *json);
        return value;
    }
    std::string place(std::string_view key) const { return join_place(place_, key); }
    const std::string& place() const { return place_; }
    void finish();

    ProblemList& problems;

private:
    void wrong_type(std::string place, std::string_view expected, const Json& json);

    const Json::Object* object_ = nullptr;
    std::string place_;
    std::vector<std::string_view> known_;
};

/// "must be a number, is a text".
void tell_type(ProblemList& problems, std::string place, std::string_view expected, const Json& json);

/// Numbers of a fixed count, told where it is anything else.
template <std::size_t N>
std::optional<std::array<float, N>> read_floats(const Json& json, const std::string& place, ProblemList& problems) {
    const auto* array = json.get<Json::Array>();
    std::array<float, N> floats{};
    bool good = array && array->size() == N;
    for (std::size_t i = 0; good && i < N; ++i) {
        const double* number = (*array)[i].template get<double>();
        good = number != nullptr;
        if (good) floats[i] = static_cast<float>(*number);
    }
    if (good) return floats;
    const bool wrong_count = array && array->size() != N;
    tell_type(problems, place, fmt::format("an array of {} numbers", N), json);
    if (wrong_count) problems.problems.back().cause = fmt::format("must be {} numbers, are {}", N, array->size());
    return std::nullopt;
}

std::optional<Vec3> read_vec3(const Json& json, const std::string& place, ProblemList& problems);
/// [r, g, b] linear, or "#rrggbb" in sRGB.
std::optional<Color> read_color(const Json& json, const std::string& place, ProblemList& problems);
std::optional<float> read_float(const Json& json, const std::string& place, ProblemList& problems);
/// {"translate", "rotate", "scale"} or {"matrix"}, checked for an object of that shape.
Transform read_transform(const Json& json, const Shape& shape, const std::string& place, ProblemList& problems);

}  // namespace rayuela
