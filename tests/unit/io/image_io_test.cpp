#include "core/io/image_io.h"

#include "core/math/srgb.h"
#include "tests/unit/io/temp_folder.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace rayuela {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;

Image random_image(int width, int height) {
    std::mt19937 rng(7);
    std::uniform_real_distribution<float> uniform;
    Image image{width, height, {}, {}};
    for (int i = 0; i < width * height; ++i) {
        image.pixels.emplace_back(uniform(rng), 10 * uniform(rng), 1e-3f * uniform(rng), 1.0f);
    }
    return image;
}

TEST(ImageIo, FloatFormatsKeepEveryBit) {
    const TempFolder folder;
    const Image image = random_image(13, 7);
    for (const char* name : {"a.exr", "a.pfm"}) {
        ASSERT_TRUE(write_image(folder.path / name, image)) << name;
        const auto read = read_image(folder.path / name, ColorDecoding::srgb);
        ASSERT_TRUE(read) << to_string(read.error());
        EXPECT_EQ((*read)->width, 13);
        EXPECT_EQ((*read)->height, 7);
        EXPECT_EQ((*read)->pixels, image.pixels) << name;
        EXPECT_EQ((*read)->source, (folder.path / name).string());
    }
}

TEST(ImageIo, RadianceHdrKeepsAnEightBitMantissa) {
    const TempFolder folder;
    const Image image = random_image(16, 9);
    ASSERT_TRUE(write_image(folder.path / "a.hdr", image));
    const auto read = read_image(folder.path / "a.hdr", ColorDecoding::linear);
    ASSERT_TRUE(read);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const Vec4 a = image.pixels[i], b = (*read)->pixels[i];
        // One exponent for three channels: the error is relative to the largest of them.
        const float bound = std::max({a.x, a.y, a.z}) / 128;
        for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(a[channel], b[channel], bound);
    }
}

TEST(ImageIo, OldRadianceRunsRepeatTheLastPixel) {
    const TempFolder folder;
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 300\n";
    // 0.5 is mantissa 128 at exponent 128; then 299 = 43 + 1 * 256 repetitions.
    const std::string row("\x80\x40\x00\x80\x01\x01\x01\x2b\x01\x01\x01\x01", 12);
    const auto read = read_image(folder.write("a.hdr", header + row), ColorDecoding::linear);
    ASSERT_TRUE(read) << to_string(read.error());
    EXPECT_EQ((*read)->at(0, 0), Vec4(0.5f, 0.25f, 0, 1));
    EXPECT_EQ((*read)->at(299, 0), Vec4(0.5f, 0.25f, 0, 1));
}

TEST(ImageIo, PngIsSrgb) {
    const TempFolder folder;
    Image image{3, 1, {}, {}};
    // IEC 61966-2-1: linear 0.21404114 is encoded as 0.5.
    image.pixels = {Vec4(0.21404114f, 0, 1, 1), Vec4(2, -1, NAN, 1), Vec4(0.5f, 0.25f, 0.75f, 1)};
    ASSERT_TRUE(write_image(folder.path / "a.png", image));
    const auto raw = read_image(folder.path / "a.png", ColorDecoding::linear);
    ASSERT_TRUE(raw);
    EXPECT_NEAR((*raw)->at(0, 0).x, 0.5f, 0.51f / 255);
    EXPECT_EQ((*raw)->at(0, 0).z, 1.0f);
    EXPECT_EQ((*raw)->at(1, 0), Vec4(1, 0, 0, 1));  // Clipped; not a number is black.
    const auto read = read_image(folder.path / "a.png", ColorDecoding::srgb);
    ASSERT_TRUE(read);
    EXPECT_NEAR((*read)->at(2, 0).y, 0.25f, 0.005f);
}

TEST(ImageIo, RowsOfPfmRunUpwards) {
    const TempFolder folder;
    std::string bytes = "Pf\n1 2\n-1\n";
    const float bottom = 1, top = 2;
    bytes.append(reinterpret_cast<const char*>(&bottom), 4).append(reinterpret_cast<const char*>(&top), 4);
    const auto read = read_image(folder.write("a.pfm", bytes), ColorDecoding::linear);
    ASSERT_TRUE(read) << to_string(read.error());
    EXPECT_EQ((*read)->at(0, 0), Vec4(2, 2, 2, 1));
    EXPECT_EQ((*read)->at(0, 1), Vec4(1, 1, 1, 1));
}

TEST(ImageIo, UnknownExtensionNamesTheKnownOnes) {
    const auto result = write_image("a.tiff", random_image(1, 1));
    ASSERT_FALSE(result);
    EXPECT_THAT(to_string(result.error()), HasSubstr("'.tiff'"));
    EXPECT_THAT(to_string(result.error()), HasSubstr(".png, .exr, .hdr, .pfm"));
    EXPECT_FALSE(is_writable_image("a.tiff"));
    EXPECT_TRUE(is_writable_image("a.PNG"));
}

TEST(ImageIo, FolderThatDoesNotExist) {
    const TempFolder folder;
    const auto result = write_image(folder.path / "no" / "a.png", random_image(2, 2));
    ASSERT_FALSE(result);
    EXPECT_THAT(to_string(result.error()), HasSubstr("cannot be written"));
}

TEST(ImageIo, AFailedWriteLeavesNothingBehind) {
    const TempFolder folder;
    std::filesystem::create_directory(folder.path / "a.png");
    EXPECT_FALSE(write_image(folder.path / "a.png", random_image(2, 2)));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 1);
}

TEST(ImageIo, DamagedFilesAreRefused) {
    const TempFolder folder;
    const Image image = random_image(40, 30);
    for (const char* name : {"a.png", "a.exr", "a.hdr", "a.pfm"}) {
        ASSERT_TRUE(write_image(folder.path / name, image));
        const std::string bytes = testing::slurp(folder.path / name);
        for (const std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{12}, bytes.size() / 2}) {
            const auto read = read_image(folder.write("cut", bytes.substr(0, size)), ColorDecoding::srgb);
            ASSERT_FALSE(read) << name << " cut to " << size;
            EXPECT_THAT(to_string(read.error()), HasSubstr("cut: "));
        }
    }
}

TEST(ImageIo, AnOpenedImageHasPixelsOnceSomebodyAsks) {
    const TempFolder folder;
    ASSERT_TRUE(write_image(folder.path / "a.png", random_image(40, 30)));
    for (const ColorDecoding decoding : {ColorDecoding::srgb, ColorDecoding::linear}) {
        const auto opened = open_image(folder.path / "a.png", decoding);
        const auto expected = read_image(folder.path / "a.png", decoding);
        ASSERT_TRUE(opened && expected);
        EXPECT_EQ((*opened)->width, 40);
        EXPECT_EQ((*opened)->height, 30);
        EXPECT_TRUE((*opened)->pixels.empty());
        ASSERT_TRUE((*opened)->encoded);
        EXPECT_EQ((*opened)->encoded->source_bytes(), std::filesystem::file_size(folder.path / "a.png"));
        EXPECT_EQ((*opened)->encoded->if_made(), nullptr);
        std::filesystem::rename(folder.path / "a.png", folder.path / "b.png");  // It is not needed any more.
        const auto seen = with_pixels(*opened);
        std::filesystem::rename(folder.path / "b.png", folder.path / "a.png");
        ASSERT_TRUE(seen);
        EXPECT_EQ(seen->pixels, (*expected)->pixels);
        EXPECT_EQ(seen->source, (*expected)->source);
        EXPECT_EQ(with_pixels(*opened), seen) << "it is decoded once";
        EXPECT_EQ(with_pixels(*expected), *expected);
    }
    ASSERT_TRUE(write_image(folder.path / "a.exr", random_image(4, 3)));
    EXPECT_EQ((*open_image(folder.path / "a.exr", ColorDecoding::linear))->pixels.size(), 12u)
        << "floats are looked at when they are read";
}

TEST(ImageIo, WhatIsWrongWithAnImageIsSaidWhenItIsOpened) {
    const TempFolder folder;
    ASSERT_TRUE(write_image(folder.path / "a.png", random_image(40, 30)));
    const std::string bytes = testing::slurp(folder.path / "a.png");
    for (std::size_t size = 0; size < bytes.size(); size += 97) {
        const auto path = folder.write("cut.png", bytes.substr(0, size));
        const auto opened = open_image(path, ColorDecoding::srgb), read = read_image(path, ColorDecoding::srgb);
        ASSERT_EQ(opened.has_value(), read.has_value()) << size;
        if (opened) {
            EXPECT_EQ((*opened)->encoded, nullptr) << size;
        } else {
            EXPECT_EQ(opened.error(), read.error()) << size;
        }
    }
    // A bit that is wrong fails the checksum of its chunk: such a file is decoded at once, whatever comes of it.
    for (std::size_t at = 8; at + 12 < bytes.size(); at += 41) {
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(damaged[at] ^ 4);
        const auto opened = open_image(folder.write("damaged.png", damaged), ColorDecoding::srgb);
        EXPECT_TRUE(!opened || !(*opened)->encoded) << at;
    }
}

TEST(ImageIo, HugeSizesAreRefusedBeforeAllocation) {
    const TempFolder folder;
    const auto pfm = read_image(folder.write("a.pfm", "PF\n2000000000 2000000000\n-1\n"), ColorDecoding::linear);
    ASSERT_FALSE(pfm);
    const auto negative = read_image(folder.write("b.pfm", "PF\n-5 5\n-1\n"), ColorDecoding::linear);
    EXPECT_FALSE(negative);
    // A PNG header of 16000 x 16000.
    std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x3e\x80\0\0\x3e\x80\x08\x02\0\0\0\0\0\0\0", 33);
    const auto result = read_image(folder.write("a.png", png), ColorDecoding::srgb);
    ASSERT_FALSE(result);
    EXPECT_THAT(to_string(result.error()), HasSubstr("too large"));
}

TEST(ImageIo, WhatIsNoImageIsNamed) {
    const TempFolder folder;
    EXPECT_THAT(to_string(read_image(folder.write("a.png", "GIF89a"), ColorDecoding::srgb).error()),
                HasSubstr("no image of a known format"));
    EXPECT_THAT(to_string(read_image(folder.path / "none.png", ColorDecoding::srgb).error()),
                HasSubstr("no such file"));
    EXPECT_THAT(to_string(read_image(folder.path, ColorDecoding::srgb).error()), HasSubstr("is a folder"));
}

}  // namespace
}  // namespace rayuela
