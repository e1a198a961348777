#include "app/bench_command.h"
#include "app/bench_meshes.h"
#include "app/clocks.h"
#include "app/count_text.h"
#include "app/median_ratio.h"
#include "app/subcommands.h"
#include "app/text_table.h"
#include "app/write_text.h"
#include "core/io/mesh_io.h"
#include "core/render/render_session.h"

#include <fmt/format.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>

namespace rayuela {

namespace {

namespace fs = std::filesystem;

struct FirstImageOptions {
    std::vector<fs::path> scenes;
    std::vector<std::string> sizes{"1M", "5M"};
    std::vector<int> threads{1, 2};
    int repetitions = 5;
    fs::path json;
};

/// Seconds since a scene was asked for.
struct Times {
    double loaded = 0;
    double trees = 0;  ///< That the first image was traced in.
    double first_image = 0, first_image_cpu = 0;
    double whole_image = 0;  ///< One sample in every pixel of the film, in the trees that the scene is meant to have.
};

using Column = double Times::*;
struct NamedColumn {
    const char* name;
    Column of;
};
constexpr NamedColumn kColumns[] = {{"loaded", &Times::loaded},
                                    {"trees", &Times::trees},
                                    {"first image", &Times::first_image},
                                    {"CPU", &Times::first_image_cpu},
                                    {"whole image", &Times::whole_image}};

/// As a window does, until the film is shown.
Result<Times> open_scene(const fs::path& file, int threads, bool drafts) {
    constexpr glm::ivec2 kFilm(320, 180);
    Times times;
    const double start = wall_seconds(), start_cpu = process_cpu_seconds();
    auto scene = load_scene(file, {.size = kFilm});
    if (!scene) return tl::unexpected(scene.error());
    times.loaded = wall_seconds() - start;

    std::mutex mutex;
    std::condition_variable changed;
    RenderSession session({.threads = threads, .drafts = drafts});
    session.on_publish([&] {
        const std::lock_guard lock(mutex);
        const auto frame = session.frame();
        if (times.first_image == 0) {
            times.first_image = wall_seconds() - start;
            times.first_image_cpu = process_cpu_seconds() - start_cpu;
            times.trees = times.loaded + frame->statistics.build_seconds;
        }
        if (!frame->coarse && times.whole_image == 0) times.whole_image = wall_seconds() - start;
        changed.notify_all();
    });
    session.submit(std::make_shared<const Scene>(std::move(*scene)));
    std::unique_lock lock(mutex);
    while (!changed.wait_for(lock, std::chrono::seconds(1), [&] { return times.whole_image > 0; })) {
        if (const std::string problem = session.status().problem; !problem.empty())
            return fail(file.string(), "", problem);
    }
    return times;
}

/// What the same rounds measured: all trees first, and drafts of them first.
struct Rounds {
    std::vector<Times> eager, drafted;
};

Result<Rounds> measure(const fs::path& file, int threads, int repetitions) {
    Rounds rounds;
    for (int i = 0; i < repetitions; ++i) {
        for (const bool drafts : {false, true}) {
            const auto times = open_scene(file, threads, drafts);
            if (!times) return tl::unexpected(times.error());
            (drafts ? rounds.drafted : rounds.eager).push_back(*times);
        }
    }
    return rounds;
}

std::vector<double> column(const std::vector<Times>& rounds, Column of) {
    std::vector<double> values;
    for (const Times& times : rounds) values.push_back(times.*of);
    return values;
}

void report(const std::string& name, int threads, const Rounds& rounds, TextTable& table,
            nlohmann::ordered_json& figures) {
    const Measured sooner =
        median_ratio(column(rounds.eager, &Times::first_image), column(rounds.drafted, &Times::first_image));
    for (const bool drafts : {false, true}) {
        const std::vector<Times>& of = drafts ? rounds.drafted : rounds.eager;
        std::vector<std::string> row{name, std::to_string(threads), drafts ? "draft first" : "at once"};
        nlohmann::ordered_json entry{{"scene", name}, {"threads", threads}, {"draft", drafts}};
        for (const NamedColumn& one : kColumns) {
            const double seconds = median(column(of, one.of));
            row.push_back(short_number(seconds));
            entry["seconds"][one.name] = seconds;
        }
        row.push_back(drafts ? short_number(sooner.value) : "");
        row.push_back(drafts ? interval_text(sooner.interval) : "");
        if (drafts) entry["sooner"] = {sooner.value, sooner.interval.low, sooner.interval.high};
        table.add(std::move(row));
        figures.push_back(std::move(entry));
    }
}

/// A mesh of land in a file, for as long as this lives.
class LandFile {
public:
    explicit LandFile(const std::string& size)
        : path_(fs::temp_directory_path() / fmt::format("rayuela-land-{}-{}.ply", size, ::getpid())) {}
    ~LandFile() {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    LandFile(const LandFile&) = delete;
    LandFile& operator=(const LandFile&) = delete;

    Result<void> write(const std::string& size) const {
        return write_mesh(path_, *bench_land(size, *parse_count(size)).make());
    }
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

Result<void> run_first_image(const FirstImageOptions& options) {
    std::vector<std::string> header{"scene", "threads", "trees"};
    for (const NamedColumn& one : kColumns) header.push_back(fmt::format("{}, s", one.name));
    header.insert(header.end(), {"sooner", "95%"});
    TextTable table(1, header);
    nlohmann::ordered_json figures = nlohmann::json::array();
    const auto measure_file = [&](const std::string& name, const fs::path& file) -> Result<void> {
        for (const int threads : options.threads) {
            const auto rounds = measure(file, threads, options.repetitions);
            if (!rounds) return tl::unexpected(rounds.error());
            report(name, threads, *rounds, table, figures);
        }
        return {};
    };
    for (const fs::path& scene : options.scenes) {
        if (auto done = measure_file(scene.filename().string(), scene); !done) return done;
    }
    for (const std::string& size : options.scenes.empty() ? options.sizes : std::vector<std::string>{}) {
        const LandFile land(size);
        if (auto written = land.write(size); !written) return written;
        if (auto done = measure_file("land " + size, land.path()); !done) return done;
    }
    fmt::print("{}", table.text());
    return write_text(options.json, figures.dump(2) + '\n');
}

}  // namespace

BenchKind add_bench_first_image(CLI::App& bench) {
    CLI::App& command = *bench.add_subcommand(
        "first-image", "Seconds from opening a file to the first image, with all trees at once and with drafts first");
    const auto options = std::make_shared<FirstImageOptions>();
    command.add_option("scene", options->scenes, "Scene and mesh files (land of --sizes triangles)")
        ->check(CLI::ExistingFile);
    command.add_option("--sizes", options->sizes, "Triangles of the made meshes, like 100k,1M")
        ->delimiter(',')
        ->check([](const std::string& text) { return parse_count(text) ? "" : text + " is no count like 10k or 1M"; });
    command.add_option("--threads", options->threads, "Worker threads, side by side")
        ->delimiter(',')
        ->check(CLI::Range(1, 1024));
    command.add_option("--repetitions", options->repetitions, "Rounds, interleaved")->check(CLI::Range(1, 1000));
    command.add_option("--json", options->json, "Write the figures to this file");
    return {&command, [options] { return run_first_image(*options); }};
}

}  // namespace rayuela
