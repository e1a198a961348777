#version 330 core
// Shows the film: exposure, tone curve, sRGB, outline of what is selected. ui/tone_map.cpp computes the same colours.
// Compiled once for each use, with the constants TONE_MAP (of ToneMap), SMOOTH_FILM (interpolate between pixels, else show
// them as squares) and OUTLINE in front: a software rasteriser executes both sides of every branch that is left.

uniform sampler2D film;       // Linear radiance, first row at the top.
uniform sampler2D selected;   // 1 where the selected object is seen; size of the film, interpolated.
uniform vec2 target_size;     // Pixels.
uniform vec2 origin;          // The image's upper left corner in the target, pixels from its upper left.
uniform vec2 image_size;      // Of the film at full resolution.
uniform float zoom;           // Target pixels an image pixel.
uniform float gain;           // Factor of the exposure.
uniform float outline_width;  // Target pixels.
uniform vec3 outline_color;   // sRGB.
uniform vec3 background;      // sRGB.
uniform float checker_size;   // Target pixels.

out vec4 color;

const float kMinEv = -12.47393, kMaxEv = 4.026069;

vec3 aces(vec3 radiance) {
    const mat3 to_rrt = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    const mat3 from_odt = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    vec3 v = to_rrt * (radiance / 0.6);
    vec3 a = v * (v + 0.0245786) - 0.000090537;
    vec3 b = v * (0.983729 * v + 0.4329510) + 0.238081;
    return from_odt * (a / b);
}

vec3 agx(vec3 radiance) {
    const mat3 inset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051,
                            0.0784335999999992, 0.878468636469772, 0.0784336,
                            0.0792237451477643, 0.0791661274605434, 0.879142973793104);
    const mat3 outset = mat3(1.19687900512017, -0.0528968517574562, -0.0529716355144438,
                             -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
                             -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
    vec3 stops = clamp(log2(max(inset * radiance, 1e-10)), kMinEv, kMaxEv);
    vec3 x = (stops - kMinEv) / (kMaxEv - kMinEv);
    vec3 x2 = x * x, x4 = x2 * x2;
    vec3 curve = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    return pow(max(outset * curve, 0.0), vec3(2.2));
}

vec3 hable(vec3 x) {
    return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.50) + 0.06) - 0.02 / 0.30;
}

vec3 filmic(vec3 radiance) {
    return hable(2.0 * radiance) / hable(vec3(11.2));
}

// Already encoded for the display.
vec3 false_color(vec3 radiance) {
    float stops = log2(max(dot(radiance, vec3(0.2126, 0.7152, 0.0722)), 1e-10) / 0.18);
    float x = clamp((stops + 8.0) / 14.0, 0.0, 1.0);
    float r = 0.13572138 + x * (4.61539260 + x * (-42.66032258 + x * (132.13108234 + x * (-152.94239396 + x * 59.28637943))));
    float g = 0.09140261 + x * (2.19418839 + x * (4.84296658 + x * (-14.18503333 + x * (4.27729857 + x * 2.82956604))));
    float b = 0.10667330 + x * (12.64194608 + x * (-60.58204836 + x * (110.36276771 + x * (-89.90310912 + x * 27.34824973))));
    return clamp(vec3(r, g, b), 0.0, 1.0);
}

vec3 srgb(vec3 linear) {
    vec3 low = 12.92 * linear;
    vec3 high = 1.055 * pow(max(linear, 0.0031308), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThanEqual(linear, vec3(0.0031308))));
}

vec3 displayed(vec3 radiance) {
    vec3 light = radiance * gain;
    if (!all(lessThan(abs(light), vec3(3.4e38)))) light = vec3(0.0);
    light = max(light, 0.0);
    if (TONE_MAP == 4) return false_color(light);
    if (TONE_MAP == 1) light = aces(light);
    if (TONE_MAP == 2) light = agx(light);
    if (TONE_MAP == 3) light = filmic(light);
    return srgb(clamp(light, 0.0, 1.0));
}

// The film around a position in texels.
vec3 film_at(vec2 texel) {
    ivec2 last = textureSize(film, 0) - 1;
    if (!SMOOTH_FILM) return texelFetch(film, clamp(ivec2(floor(texel)), ivec2(0), last), 0).rgb;
    vec2 corner = texel - 0.5;
    ivec2 low = ivec2(floor(corner));
    vec2 weight = corner - floor(corner);
    vec3 upper = mix(texelFetch(film, clamp(low, ivec2(0), last), 0).rgb,
                     texelFetch(film, clamp(low + ivec2(1, 0), ivec2(0), last), 0).rgb, weight.x);
    vec3 lower = mix(texelFetch(film, clamp(low + ivec2(0, 1), ivec2(0), last), 0).rgb,
                     texelFetch(film, clamp(low + ivec2(1, 1), ivec2(0), last), 0).rgb, weight.x);
    return mix(upper, lower, weight.y);
}

// Where one target pixel covers several texels, their mean.
vec3 filtered_film(vec2 texel, float texels) {
    int taps = clamp(int(ceil(texels)), 1, 4);
    if (!SMOOTH_FILM || taps == 1) return film_at(texel);
    vec3 sum = vec3(0.0);
    for (int y = 0; y < taps; ++y) {
        for (int x = 0; x < taps; ++x) {
            sum += film_at(texel + (vec2(x, y) + 0.5 - 0.5 * float(taps)) * texels / float(taps));
        }
    }
    return sum / float(taps * taps);
}

bool is_selected(vec2 texel) {
    return textureLod(selected, texel / vec2(textureSize(selected, 0)), 0.0).r > 0.5;
}

// How much of the outline covers a position just outside the selected object.
float outline(vec2 texel, float texels) {
    if (is_selected(texel)) return 0.0;
    float reach = outline_width * texels;
    float neighbours = 0.0;
    for (int i = 0; i < 12; ++i) {
        float angle = 0.5235988 * float(i);
        if (is_selected(texel + reach * vec2(cos(angle), sin(angle)))) neighbours += 1.0;
    }
    return min(neighbours / 2.0, 1.0);
}

void main() {
    vec2 position = vec2(gl_FragCoord.x, target_size.y - gl_FragCoord.y) - origin;
    vec2 pixel = position / zoom;
    if (any(lessThan(pixel, vec2(0.0))) || any(greaterThanEqual(pixel, image_size))) {
        vec2 square = floor(vec2(gl_FragCoord.x, target_size.y - gl_FragCoord.y) / checker_size);
        color = vec4(background * (mod(square.x + square.y, 2.0) < 0.5 ? 1.0 : 1.18), 1.0);
        return;
    }
    vec2 texels_per_pixel = vec2(textureSize(film, 0)) / image_size;
    vec2 texel = pixel * texels_per_pixel;
    float texels = texels_per_pixel.x / zoom;
    vec3 shown = displayed(filtered_film(texel, texels));
    if (OUTLINE) shown = mix(shown, outline_color, outline(texel, texels));
    color = vec4(shown, 1.0);
}
