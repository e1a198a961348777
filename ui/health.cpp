#include "ui/health.h"

#include "core/render/health_maps.h"
#include "ui/map_colors.h"

#include <numeric>

namespace rayuela {

namespace {

/// Work for a scene that is no longer on screen may take so long before it is broken off: while the camera moves a map
/// that is late is better than none.
constexpr double kPatience = 0.3;
constexpr std::uint32_t kMeasuredPaths = 20'000;
/// Apart from the versions of a session.
constexpr std::uint64_t kPictureVersion = 1ull << 63;

glm::ivec2 film_size(const RenderScene& scene) {
    return {scene.scene().film.width, scene.scene().film.height};
}

std::vector<float> values_of(ViewMap map, const Frame& frame, const std::atomic<bool>& cancelled) {
    const RenderScene& scene = *frame.render_scene;
    switch (map) {
        case ViewMap::samples:
            return sample_map(frame.sampled_blocks, frame.statistics.spp, film_size(scene));
        case ViewMap::rejected:
            return rejected_map(frame.rejected_pixels, film_size(scene));
        case ViewMap::position_error:
            return position_error_map(scene, film_size(scene), cancelled);
        case ViewMap::retrace:
            return retrace_map(scene, film_size(scene), cancelled);
        case ViewMap::image:
            break;
    }
    return {};
}

std::shared_ptr<const Frame> picture_of(ViewMap map, std::span<const float> values, const Frame& frame,
                                        std::uint64_t version) {
    auto picture = std::make_shared<Frame>();
    picture->version = version;
    const glm::ivec2 size = film_size(*frame.render_scene);
    picture->image = map_image(map, values, size);
    picture->scene = frame.render_scene->shared_scene();
    picture->render_scene = frame.render_scene;
    return picture;
}

}  // namespace

void Health::update(const std::shared_ptr<const Frame>& frame, ViewMap wanted) {
    scene_ = frame ? frame->render_scene : nullptr;
    if (auto counted = measurement_.take(); counted && !measurement_.is_cancelled()) measured_ = *counted;
    if (measured_scene_ != scene_) {
        measured_.reset();
        measured_scene_.reset();
        measurement_.cancel();
    }
    update_map(frame, wanted);
    update_replay();
}

void Health::update_map(const std::shared_ptr<const Frame>& frame, ViewMap wanted) {
    if (auto finished = map_work_.take(); finished && !finished->values.empty()) map_ = std::move(finished);
    const bool of_another_size = map_ && scene_ && film_size(*map_->key.scene) != film_size(*scene_);
    if (map_ && (map_->key.map != wanted || of_another_size)) map_.reset();
    if (wanted == ViewMap::image || !scene_) return map_work_.cancel();

    MapKey key{.map = wanted, .scene = scene_};
    const RenderStatistics& statistics = frame->statistics;
    if (wanted == ViewMap::samples || wanted == ViewMap::rejected) key.restarts = statistics.restarts;
    if (wanted == ViewMap::samples) key.counted = statistics.samples;
    if (wanted == ViewMap::rejected) {
        key.counted = std::accumulate(statistics.rejected.begin(), statistics.rejected.end(), std::uint64_t{0});
    }
    if (map_ && map_->key == key) return;
    if (map_work_.is_busy()) {
        const bool of_another_map = worked_out_.map != wanted;
        if (worked_out_ != key && (of_another_map || map_work_.seconds() > kPatience)) map_work_.cancel();
        return;
    }
    worked_out_ = key;
    map_work_.start([key, frame, version = kPictureVersion + ++pictures_](const std::atomic<bool>& cancelled) {
        Map map{key, values_of(key.map, *frame, cancelled), nullptr};
        if (!map.values.empty()) map.picture = picture_of(key.map, map.values, *frame, version);
        return map;
    });
}

std::optional<float> Health::value(const glm::ivec2& pixel) const {
    if (!map_) return std::nullopt;
    const glm::ivec2 size = film_size(*map_->key.scene);
    if (pixel.x < 0 || pixel.y < 0 || pixel.x >= size.x || pixel.y >= size.y) return std::nullopt;
    return map_->values[static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(size.x) +
                        static_cast<std::size_t>(pixel.x)];
}

void Health::measure() {
    if (!scene_ || measurement_.is_busy()) return;
    measured_.reset();
    measured_scene_ = scene_;
    measurement_.start([scene = scene_](const std::atomic<bool>& cancelled) {
        return measure_path_health(*scene, kMeasuredPaths, cancelled);
    });
}

void Health::update_replay() {
    const glm::ivec2 size = scene_ ? film_size(*scene_) : glm::ivec2(0);
    const glm::ivec2& at = replayed_pixel;
    if (!replays || at.x < 0 || at.y < 0 || at.x >= size.x || at.y >= size.y) return replay_.reset();
    const PathId id{static_cast<std::uint32_t>(at.y * size.x + at.x), static_cast<std::uint32_t>(replayed_sample)};
    const bool is_there = replay_ && replay_->first.scene == scene_ && replay_->first.id.pixel == id.pixel &&
                          replay_->first.id.sample == id.sample;
    if (!is_there) replay_.emplace(ReplayKey{scene_, id}, replay(*scene_, id));
}

}  // namespace rayuela
