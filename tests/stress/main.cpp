#include "tests/stress/stress.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <charconv>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <optional>

namespace rayuela::stress {
namespace {

constexpr std::string_view kUsage = R"(Usage: rayuela_stress [--quick | --scale X] [--json FILE] [--list] [FILTER...]

Runs the randomised tests and prints one table. A filter is a number, a range (7-13) or a part of a name; without one
all run. --quick is --scale 0.001: that share of the full number of cases. Exit status 1: a figure was missed.
)";
constexpr double kQuickScale = 0.001;

struct Options {
    double scale = 1;
    std::string json = "stress.json";
    bool list = false;
    std::vector<std::string> filters;
};

template <typename T>
std::optional<T> to_number(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// Nothing where they cannot be understood.
std::optional<Options> parse(const std::vector<std::string>& arguments) {
    Options options;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string& argument = arguments[i];
        const bool has_value = i + 1 < arguments.size();
        if (argument == "--quick") {
            options.scale = kQuickScale;
        } else if (argument == "--list") {
            options.list = true;
        } else if (argument == "--scale" && has_value) {
            const auto scale = to_number<double>(arguments[++i]);
            if (!scale || !(*scale > 0)) return std::nullopt;
            options.scale = *scale;
        } else if (argument == "--json" && has_value) {
            options.json = arguments[++i];
        } else if (argument.starts_with("--")) {
            return std::nullopt;
        } else {
            options.filters.push_back(argument);
        }
    }
    return options;
}

bool matches(const StressTest& test, std::string_view filter) {
    if (const auto number = to_number<int>(filter)) return test.number == *number;
    if (const auto dash = filter.find('-'); dash != std::string_view::npos) {
        const auto first = to_number<int>(filter.substr(0, dash)), last = to_number<int>(filter.substr(dash + 1));
        if (first && last) return test.number >= *first && test.number <= *last;
    }
    return test.name.find(filter) != std::string_view::npos;
}

void print_row(const StressTest& test, const Outcome& outcome, double seconds) {
    fmt::print("{:>3}  {:<52}{:>13}{:>10}  {:>9.3g} <= {:<8.3g} {:<22}{:<5}{:>8.1f}\n", test.number, test.name,
               outcome.cases, outcome.failures, outcome.worst, test.required, test.figure,
               test.passed(outcome) ? "pass" : "MISS", seconds);
    if (!outcome.failure.empty()) fmt::print("     first failure: {}\n", outcome.failure);
    if (!outcome.note.empty()) fmt::print("     {}\n", outcome.note);
    std::fflush(stdout);
}

nlohmann::json to_json(const StressTest& test, const Outcome& outcome, double seconds) {
    // JSON has no infinity.
    const auto number = [](double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json("infinite"); };
    return {{"number", test.number},     {"name", test.name},
            {"cases", outcome.cases},    {"failures", outcome.failures},
            {"figure", test.figure},     {"worst", number(outcome.worst)},
            {"required", test.required}, {"passed", test.passed(outcome)},
            {"seconds", seconds},        {"first_failure", outcome.failure},
            {"note", outcome.note}};
}

int run(const Options& options) {
    nlohmann::json rows = nlohmann::json::array();
    int missed = 0;
    double total = 0;
    fmt::print("{:>3}  {:<52}{:>13}{:>10}  {:>9}    {:<8} {:<22}{:<5}{:>8}\n", "", "test", "cases", "failures", "worst",
               "required", "", "", "seconds");
    for (const StressTest& test : stress_tests()) {
        const auto chosen = [&](const std::string& filter) { return matches(test, filter); };
        if (!options.filters.empty() && std::ranges::none_of(options.filters, chosen)) continue;
        if (options.list) {
            fmt::print("{:>3}  {}\n", test.number, test.name);
            continue;
        }
        const auto start = std::chrono::steady_clock::now();
        const Outcome outcome = test.run(options.scale);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        print_row(test, outcome, seconds);
        rows.push_back(to_json(test, outcome, seconds));
        if (!test.passed(outcome)) ++missed;
        total += seconds;
    }
    if (options.list) return 0;
    fmt::print("{} tests at {:g} of the full counts in {:.1f} s, {} missed\n", rows.size(), options.scale, total,
               missed);
    if (rows.empty()) return 2;
    std::ofstream(options.json) << nlohmann::json{{"scale", options.scale}, {"seconds", total}, {"tests", rows}}.dump(1)
                                << '\n';
    return missed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace rayuela::stress

int main(int argc, char** argv) {
    const auto options = rayuela::stress::parse({argv + 1, argv + argc});
    if (!options) {
        fmt::print(stderr, "{}", rayuela::stress::kUsage);
        return 2;
    }
    return rayuela::stress::run(*options);
}
