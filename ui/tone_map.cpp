#include "ui/tone_map.h"

#include "core/math/srgb.h"

#include <algorithm>
#include <cmath>

namespace rayuela {
namespace {

/// Stephen Hill's fit of ACES' reference rendering and output transforms (BakingLab, ACES.hlsl). Middle grey is scaled
/// by 1 / 0.6, as viewers do, so that it keeps about its brightness.
Color aces(const Color& radiance) {
    static const Mat3 kToRrt{0.59719f, 0.07600f, 0.02840f, 0.35458f, 0.90834f, 0.13383f, 0.04823f, 0.01566f, 0.83777f};
    static const Mat3 kFromOdt{1.60475f,  -0.10208f, -0.00327f, -0.53108f, 1.10813f,
                               -0.07276f, -0.07367f, -0.00605f, 1.07602f};
    const Color v = kToRrt * (radiance / 0.6f);
    const Color a = v * (v + 0.0245786f) - 0.000090537f;
    const Color b = v * (0.983729f * v + 0.4329510f) + 0.238081f;
    return kFromOdt * (a / b);
}

/// Troy Sobotka's AgX in Benjamin Wrensch's approximation ("Minimal AgX Implementation", 2023).
Color agx(const Color& radiance) {
    static const Mat3 kInset{0.842479062253094f,  0.0423282422610123f, 0.0423756549057051f,
                             0.0784335999999992f, 0.878468636469772f,  0.0784336f,
                             0.0792237451477643f, 0.0791661274605434f, 0.879142973793104f};
    static const Mat3 kOutset{1.19687900512017f,    -0.0528968517574562f, -0.0529716355144438f,
                              -0.0980208811401368f, 1.15190312990417f,    -0.0980434501171241f,
                              -0.0990297440797205f, -0.0989611768448433f, 1.15107367264116f};
    constexpr float kMinEv = -12.47393f, kMaxEv = 4.026069f;
    const Color stops = glm::clamp(glm::log2(glm::max(kInset * radiance, Color(1e-10f))), kMinEv, kMaxEv);
    const Color x = (stops - kMinEv) / (kMaxEv - kMinEv);
    const Color x2 = x * x, x4 = x2 * x2;
    const Color curve =
        15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 + 0.1191f * x - 0.00232f;
    return glm::pow(glm::max(kOutset * curve, Color(0)), Color(2.2f));
}

/// John Hable's curve of Uncharted 2, white at 11.2.
Color filmic(const Color& radiance) {
    const auto curve = [](const Color& x) {
        return (x * (0.15f * x + 0.05f) + 0.004f) / (x * (0.15f * x + 0.50f) + 0.06f) - 0.02f / 0.30f;
    };
    return curve(2.0f * radiance) / curve(Color(11.2f));
}

/// Luminance in stops from middle grey, -8 to +6, in Anton Mikhailov's polynomial of the Turbo colours (which are
/// display-encoded, so they are made linear).
Color false_color(const Color& radiance) {
    const float stops = std::log2(std::max(luminance(radiance), 1e-10f) / 0.18f);
    const float x = std::clamp((stops + 8) / 14, 0.0f, 1.0f);
    const float r =
        0.13572138f +
        x * (4.61539260f + x * (-42.66032258f + x * (132.13108234f + x * (-152.94239396f + x * 59.28637943f))));
    const float g =
        0.09140261f + x * (2.19418839f + x * (4.84296658f + x * (-14.18503333f + x * (4.27729857f + x * 2.82956604f))));
    const float b =
        0.10667330f +
        x * (12.64194608f + x * (-60.58204836f + x * (110.36276771f + x * (-89.90310912f + x * 27.34824973f))));
    return {srgb_to_linear(std::clamp(r, 0.0f, 1.0f)), srgb_to_linear(std::clamp(g, 0.0f, 1.0f)),
            srgb_to_linear(std::clamp(b, 0.0f, 1.0f))};
}

}  // namespace

Color tone_mapped(const Color& radiance, float exposure, ToneMap tone_map) {
    Color color = radiance * std::exp2(exposure);
    if (!is_finite(color)) return Color(0);
    color = glm::max(color, Color(0));
    switch (tone_map) {
        case ToneMap::linear:
            break;
        case ToneMap::aces:
            color = aces(color);
            break;
        case ToneMap::agx:
            color = agx(color);
            break;
        case ToneMap::filmic:
            color = filmic(color);
            break;
        case ToneMap::false_color:
            color = false_color(color);
            break;
    }
    return glm::clamp(color, Color(0), Color(1));
}

Image tone_mapped(const Image& image, float exposure, ToneMap tone_map) {
    Image result{image.width, image.height, std::vector<Vec4>(image.pixels.size()), {}};
    std::ranges::transform(image.pixels, result.pixels.begin(),
                           [&](const Vec4& pixel) { return Vec4(tone_mapped(Color(pixel), exposure, tone_map), 1); });
    return result;
}

}  // namespace rayuela
