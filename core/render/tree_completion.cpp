#include "core/render/tree_completion.h"

#include <tbb/task_arena.h>

#include <algorithm>

namespace rayuela {

TreeCompletion::TreeCompletion(std::shared_ptr<const RenderScene> scene, int threads, Done done)
    : scene_(std::move(scene)), thread_([this, threads, done = std::move(done)] { run(threads, done); }) {}

TreeCompletion::~TreeCompletion() {
    control_.cancelled = true;
    thread_.join();
}

void TreeCompletion::run(int threads, const Done& done) {
    std::shared_ptr<const Accelerator> trees;
    try {
        tbb::task_arena arena(threads);
        trees = arena.execute([&] { return scene_->without_drafts(control_); });
    } catch (const std::exception&) {
        // The drafts stay in use.
    }
    if (!control_.cancelled) done(std::move(trees));
}

bool TreeCompletion::suits(const RenderScene& scene) const {
    return scene.accelerator().settings() == scene_->accelerator().settings();
}

double TreeCompletion::progress() const {
    const auto total = static_cast<double>(control_.total);
    return total > 0 ? std::min(1.0, static_cast<double>(control_.done) / total) : 0;
}

}  // namespace rayuela
