#include "core/io/json_reader.h"

#include "core/math/srgb.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace rayuela {

void tell_type(ProblemList& problems, std::string place, std::string_view expected, const Json& json) {
    problems.add(std::move(place), fmt::format("must be {}, is {}", expected, json.type_name()));
}

JsonObject::JsonObject(const Json& json, std::string place, ProblemList& list)
    : problems(list), object_(json.get<Json::Object>()), place_(std::move(place)) {
    static const Json::Object kEmpty;
    if (object_) return;
    object_ = &kEmpty;
    wrong_type(place_, "an object", json);
}

const Json* JsonObject::take(std::string_view key) {
    known_.push_back(key);
    const auto found = std::ranges::find(*object_, key, &Json::Member::first);
    return found == object_->end() ? nullptr : &found->second;
}

void JsonObject::finish() {
    if (object_->empty()) return;
    std::vector<std::string_view> known = known_;
    std::ranges::sort(known);
    for (const auto& [key, value] : *object_) {
        if (std::ranges::binary_search(known, key)) continue;
        problems.add(place(key), fmt::format("unknown key; known are {}", fmt::join(known_, ", ")));
    }
}

void JsonObject::wrong_type(std::string place, std::string_view expected, const Json& json) {
    tell_type(problems, std::move(place), expected, json);
}

std::optional<Vec3> read_vec3(const Json& json, const std::string& place, ProblemList& problems) {
    const auto floats = read_floats<3>(json, place, problems);
    if (!floats) return std::nullopt;
    return Vec3((*floats)[0], (*floats)[1], (*floats)[2]);
}

std::optional<Color> read_color(const Json& json, const std::string& place, ProblemList& problems) {
    const auto* text = json.get<std::string>();
    if (!text) return read_vec3(json, place, problems);
    Color color;
    bool good = text->size() == 7 && text->front() == '#';
    for (int channel = 0; good && channel < 3; ++channel) {
        int byte = 0;
        const char* const first = text->data() + 1 + 2 * channel;
        const auto [end, error] = std::from_chars(first, first + 2, byte, 16);
        good = error == std::errc() && end == first + 2 && byte >= 0;
        color[channel] = srgb_to_linear(static_cast<float>(byte) / 255);
    }
    if (good) return color;
    problems.add(place, fmt::format("'{}' is no colour: write \"#rrggbb\" or three numbers", *text));
    return std::nullopt;
}

std::optional<float> read_float(const Json& json, const std::string& place, ProblemList& problems) {
    const double* number = json.get<double>();
    if (number) return static_cast<float>(*number);
    tell_type(problems, place, "a number", json);
    return std::nullopt;
}

}  // namespace rayuela
