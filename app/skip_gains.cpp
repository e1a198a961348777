#include "app/skip_gains.h"

#include "app/clocks.h"
#include "app/median_ratio.h"
#include "core/render/progressive_renderer.h"

#include <algorithm>

namespace rayuela {

namespace {

/// A render that is repeated, and how long each took.
class Contestant {
public:
    Contestant(const std::shared_ptr<const Scene>& scene, const Shortcuts& shortcuts)
        : renderer_(false, 1, {.shortcuts = shortcuts}) {
        BuildControl control;
        renderer_.take(scene, control);
    }

    void render(int samples) {
        const std::atomic<bool> cancelled{false};
        std::atomic<std::uint64_t> done{0};
        renderer_.restart();
        const double start = process_cpu_seconds();
        renderer_.render({.samples = samples}, cancelled, done);
        seconds.push_back(process_cpu_seconds() - start);
    }
    std::shared_ptr<const Frame> frame() { return renderer_.publish(SessionPhase::rendering); }

    std::vector<double> seconds;

private:
    ProgressiveRenderer renderer_;
};

struct PutBack {
    SkipGain gain;
    std::unique_ptr<Contestant> contestant;
};

std::vector<PutBack> put_back_each(const std::shared_ptr<const Scene>& scene, const Frame& frame) {
    std::vector<PutBack> all;
    for (const Skip& skip : skips_of(frame)) {
        if (!skip.shortcut || skip.state != SkipState::skipped) continue;
        Shortcuts shortcuts;
        shortcuts.*skip.shortcut->member = false;
        all.push_back({{skip.shortcut, skip.name, {}}, std::make_unique<Contestant>(scene, shortcuts)});
    }
    return all;
}

}  // namespace

Scene shrunk(Scene scene, int side) {
    const int longest = std::max(scene.film.width, scene.film.height);
    const auto shorter = [&](int length) { return std::max(1, length * std::min(side, longest) / longest); };
    scene.film.width = shorter(scene.film.width);
    scene.film.height = shorter(scene.film.height);
    return scene;
}

Result<std::vector<SkipGain>> measure_skips(const Scene& scene, const SkipGainOptions& options) {
    const auto small = std::make_shared<const Scene>(shrunk(scene, options.side));
    Contestant plain(small, {});
    plain.render(options.samples);
    const auto expected = plain.frame();
    std::vector<PutBack> others = put_back_each(small, *expected);
    for (int round = 0; round < options.repetitions; ++round) {
        if (round > 0) plain.render(options.samples);
        for (PutBack& other : others) other.contestant->render(options.samples);
    }
    std::vector<SkipGain> gains;
    for (PutBack& other : others) {
        if (other.contestant->frame()->image.pixels != expected->image.pixels)
            return fail("", std::string(other.gain.skip), "putting this back changes the image");
        other.gain.ratio = median_ratio(other.contestant->seconds, plain.seconds);
        gains.push_back(other.gain);
    }
    return gains;
}

}  // namespace rayuela
