#include "ui/display.h"

#include "ui/embedded.h"
#include "ui/theme.h"

#include <fmt/format.h>
#include <glad/glad.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace rayuela {

namespace {

/// From this zoom on pixels are shown as squares rather than blended.
constexpr float kSquarePixelZoom = 1.999f;
constexpr Vec3 kBackground{0.066f, 0.070f, 0.075f};
constexpr float kMaxDivisor = 4;
constexpr int kTileSide = 64;

/// `constants` goes below the first line, which is the version.
unsigned compile(GLenum kind, std::string_view name, const std::string& constants) {
    const std::string_view text = embedded_shader(name);
    const std::size_t first_line = text.find('\n') + 1;
    const char* const parts[] = {text.data(), constants.data(), text.data() + first_line};
    const int lengths[] = {static_cast<int>(first_line), static_cast<int>(constants.size()),
                           static_cast<int>(text.size() - first_line)};
    const unsigned shader = glCreateShader(kind);
    glShaderSource(shader, 3, parts, lengths);
    glCompileShader(shader);
    int compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
        char message[1024] = {};
        glGetShaderInfoLog(shader, sizeof message, nullptr, message);
        throw std::runtime_error(fmt::format("shaders/{}: {}", name, message));
    }
    return shader;
}

unsigned link_program(const std::string& constants) {
    const unsigned vertex = compile(GL_VERTEX_SHADER, "display.vert", "");
    const unsigned fragment = compile(GL_FRAGMENT_SHADER, "display.frag", constants);
    const unsigned program = glCreateProgram();
    glAttachShader(program, vertex);
    glAttachShader(program, fragment);
    glLinkProgram(program);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    return program;
}

unsigned make_texture(int filter) {
    unsigned texture = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

/// Whether two images of one size differ within [low, high).
bool differ(const Image& a, const Image& b, glm::ivec2 low, glm::ivec2 high) {
    const auto bytes = static_cast<std::size_t>(high.x - low.x) * sizeof(Vec4);
    for (int y = low.y; y < high.y; ++y) {
        if (std::memcmp(&a.at(low.x, y), &b.at(low.x, y), bytes) != 0) return true;
    }
    return false;
}

/// Calls `upload(low, high)` for runs of neighbouring tiles that have changed; all of them where there is nothing before.
template <typename Upload>
void for_each_changed_part(const Image* before, const Image& now, const Upload& upload) {
    for (int top = 0; top < now.height; top += kTileSide) {
        const int bottom = std::min(top + kTileSide, now.height);
        int run = 0;  // Where the run of changed tiles begins that ends at `left`.
        for (int left = 0; left < now.width; left += kTileSide) {
            const int right = std::min(left + kTileSide, now.width);
            if (!before || differ(*before, now, {left, top}, {right, bottom})) continue;
            if (run < left) upload({run, top}, {left, bottom});
            run = right;
        }
        if (run < now.width) upload({run, top}, {now.width, bottom});
    }
}

/// By how much smaller than it is shown a preview may be drawn: two pixels for each of its large ones.
int preview_divisor(const Frame& frame, const DisplayRequest& request) {
    if (!frame.coarse || !frame.scene || frame.image.width < 1) return 1;
    const int film = frame.scene->film.width;
    const float shown = request.zoom * static_cast<float>(film) / static_cast<float>(frame.image.width);
    return static_cast<int>(std::clamp(shown / 2, 1.0f, kMaxDivisor));
}

DisplayRequest divided(DisplayRequest request, int divisor) {
    const auto factor = 1 / static_cast<float>(divisor);
    request.size = (request.size + divisor - 1) / divisor;
    request.origin *= factor;
    request.zoom *= factor;
    request.checker_size *= factor;
    // Thinner than a pixel it would be broken.
    if (request.outline_width > 0) request.outline_width = std::max(request.outline_width * factor, 1.0f);
    return request;
}

}  // namespace

Display::Display()
    : film_(make_texture(GL_NEAREST)), mask_(make_texture(GL_LINEAR)), target_(make_texture(GL_NEAREST)) {
    glGenVertexArrays(1, &vertex_array_);
    glGenFramebuffers(1, &framebuffer_);
}

Display::~Display() {
    const unsigned textures[] = {film_, mask_, target_};
    glDeleteTextures(3, textures);
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteVertexArrays(1, &vertex_array_);
    for (const auto& [use, program] : programs_) {
        glDeleteProgram(program);
    }
}

unsigned Display::program(ToneMap tone_map, bool smooth, bool outline) {
    unsigned& program = programs_[{tone_map, smooth, outline}];
    if (!program) {
        program = link_program(
            fmt::format("const int TONE_MAP = {};\nconst bool SMOOTH_FILM = {};\nconst bool OUTLINE = {};\n",
                        static_cast<int>(tone_map), smooth, outline));
    }
    return program;
}

Display::Picture Display::draw(const std::shared_ptr<const Frame>& frame, const DisplayRequest& request) {
    if (request.size.x < 1 || request.size.y < 1) return {};
    const Frame nothing;
    const Frame& shown = frame ? *frame : nothing;
    if (shown.version == drawn_version_ && request == drawn_) return {target_, lower_right_};

    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (!shown.image.pixels.empty() && (!uploaded_ || shown.version != uploaded_->version)) upload_film(frame);
    const bool outlines = request.outline_width > 0 && !request.outlined.empty() && !shown.object_ids.empty();
    if (outlines && (shown.version != mask_version_ || request.outlined != masked_)) {
        upload_mask(shown, request.outlined);
        mask_version_ = shown.version;
        masked_ = request.outlined;
    }
    const int divisor = preview_divisor(shown, request);
    const DisplayRequest reduced = divided(request, divisor);
    prepare_target(reduced.size, divisor > 1);
    draw_film(shown, reduced);
    const Vec2 covered = Vec2(request.size) / Vec2(reduced.size * divisor);
    lower_right_ = {covered.x, 1 - covered.y};
    drawn_version_ = shown.version;
    drawn_ = request;
    return {target_, lower_right_};
}

void Display::upload_film(const std::shared_ptr<const Frame>& frame) {
    const auto start = std::chrono::steady_clock::now();
    const Image& image = frame->image;
    const glm::ivec2 size(image.width, image.height);
    const Image* before = uploaded_ && size == film_size_ ? &uploaded_->image : nullptr;
    glBindTexture(GL_TEXTURE_2D, film_);
    if (!before) glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, size.x, size.y, 0, GL_RGBA, GL_FLOAT, nullptr);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, size.x);
    for_each_changed_part(before, image, [&](glm::ivec2 low, glm::ivec2 high) {
        const glm::ivec2 extent = high - low;
        glTexSubImage2D(GL_TEXTURE_2D, 0, low.x, low.y, extent.x, extent.y, GL_RGBA, GL_FLOAT, &image.at(low.x, low.y));
        statistics_.uploaded_pixels += static_cast<std::uint64_t>(extent.x) * static_cast<std::uint64_t>(extent.y);
    });
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    film_size_ = size;
    uploaded_ = frame;
    ++statistics_.uploads;
    statistics_.upload_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Display::upload_mask(const Frame& frame, const std::vector<ObjectId>& outlined) {
    const auto last = std::ranges::max(frame.object_ids);
    std::vector<std::uint8_t> is_outlined(static_cast<std::size_t>(last) + 1, 0);
    for (const ObjectId id : outlined) {
        if (id.value <= last) is_outlined[id.value] = 255;
    }
    const glm::ivec2 size(frame.image.width, frame.image.height);
    std::vector<std::uint8_t> mask(frame.object_ids.size());
    glm::ivec2 low = size, high(0);
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x);
            mask[i] = is_outlined[frame.object_ids[i]];
            if (!mask[i]) continue;
            low = glm::min(low, glm::ivec2(x, y));
            high = glm::max(high, glm::ivec2(x + 1, y + 1));
        }
    }
    mask_bounds_ = glm::ivec4(low, high);
    glBindTexture(GL_TEXTURE_2D, mask_);
    if (size == mask_size_) {
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size.x, size.y, GL_RED, GL_UNSIGNED_BYTE, mask.data());
    } else {
        glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, size.x, size.y, 0, GL_RED, GL_UNSIGNED_BYTE, mask.data());
        mask_size_ = size;
    }
}

void Display::prepare_target(glm::ivec2 size, bool enlarged) {
    glBindTexture(GL_TEXTURE_2D, target_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, enlarged ? GL_LINEAR : GL_NEAREST);
    if (size == target_size_) return;
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, size.x, size.y, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    target_size_ = size;
}

void Display::draw_film(const Frame& frame, const DisplayRequest& request) {
    int outer = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &outer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target_, 0);
    glViewport(0, 0, request.size.x, request.size.y);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, mask_);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, film_);
    glBindVertexArray(vertex_array_);

    draw_triangle(frame, request, false);
    const bool outlines = request.outline_width > 0 && !request.outlined.empty() && mask_size_ == film_size_;
    if (outlines && frame.scene) {
        // Once more, and only around the outline, which is costly for a software rasteriser.
        const Vec2 texel = Vec2(frame.scene->film.width, frame.scene->film.height) / Vec2(film_size_) * request.zoom;
        const Vec2 margin(request.outline_width + 1);
        const glm::ivec2 low(glm::floor(request.origin + Vec2(mask_bounds_.x, mask_bounds_.y) * texel - margin));
        const glm::ivec2 high(glm::ceil(request.origin + Vec2(mask_bounds_.z, mask_bounds_.w) * texel + margin));
        const glm::ivec2 extent = glm::max(high - low, 0);
        glEnable(GL_SCISSOR_TEST);
        glScissor(low.x, request.size.y - high.y, extent.x, extent.y);
        draw_triangle(frame, request, true);
        glDisable(GL_SCISSOR_TEST);
    }
    glBindVertexArray(0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<unsigned>(outer));
    ++statistics_.draws;
}

void Display::draw_triangle(const Frame& frame, const DisplayRequest& request, bool outline) {
    const bool has_film = frame.scene && !frame.image.pixels.empty();
    const Vec2 image_size = has_film ? Vec2(frame.scene->film.width, frame.scene->film.height) : Vec2(0);
    // Where pixels of film and target coincide there is nothing to interpolate.
    const bool coincide = request.zoom == 1 && image_size == Vec2(film_size_);
    const bool smooth = !coincide && (frame.coarse || request.zoom < kSquarePixelZoom);
    const unsigned used = program(request.tone_map, smooth, outline);
    const auto at = [used](const char* name) { return glGetUniformLocation(used, name); };
    glUseProgram(used);
    glUniform1i(at("film"), 0);
    glUniform1i(at("selected"), 1);
    glUniform2f(at("target_size"), static_cast<float>(request.size.x), static_cast<float>(request.size.y));
    glUniform2f(at("origin"), request.origin.x, request.origin.y);
    glUniform2f(at("image_size"), image_size.x, image_size.y);
    glUniform1f(at("zoom"), request.zoom);
    glUniform1f(at("gain"), std::exp2(request.exposure));
    glUniform1f(at("outline_width"), request.outline_width);
    glUniform3f(at("outline_color"), theme::kAccent.x, theme::kAccent.y, theme::kAccent.z);
    glUniform3f(at("background"), kBackground.x, kBackground.y, kBackground.z);
    glUniform1f(at("checker_size"), request.checker_size);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

std::vector<ObjectId> with_children(const Scene& scene, ObjectId id) {
    std::vector<ObjectId> found{id};
    // Parents stand before their children.
    for (const Object& object : scene.objects) {
        if (std::ranges::find(found, object.parent) != found.end()) found.push_back(object.id);
    }
    return found;
}

}  // namespace rayuela
