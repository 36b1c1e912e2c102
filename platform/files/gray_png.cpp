#include "platform/files/gray_png.hpp"

#include <png.h>

#include <memory>
#include <string>

#include "platform/files/input_error.hpp"

namespace crspf {

namespace {

/// libpng's simplified interface reports an error in the image's own message field.
class PngImage {
 public:
    PngImage() { image_.version = PNG_IMAGE_VERSION; }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
    ~PngImage() { png_image_free(&image_); }

    [[nodiscard]] png_image* get() { return &image_; }
    [[nodiscard]] const char* message() const { return static_cast<const char*>(image_.message); }

 private:
    png_image image_{};
};

}  // namespace

GrayImage decode_gray_png(std::span<const std::uint8_t> bytes, std::string_view name) {
    PngImage png;
    const auto fail = [&](const std::string& reason) -> InputError {
        return InputError{std::string(name) + ": " + reason + "; a PNG picture is expected"};
    };
    if (png_image_begin_read_from_memory(png.get(), bytes.data(), bytes.size()) == 0) {
        throw fail(png.message());
    }
    const auto side_max = static_cast<png_uint_32>(kGraySideMax);
    if (png.get()->width > side_max || png.get()->height > side_max) {
        throw fail("is larger than " + std::to_string(kGraySideMax) + " pixels a side");
    }
    png.get()->format = PNG_FORMAT_GRAY;
    GrayImage out(static_cast<int>(png.get()->width), static_cast<int>(png.get()->height));
    const png_color black{};
    if (png_image_finish_read(png.get(), &black, out.pixels.data(), out.width, nullptr) == 0) {
        throw fail(png.message());
    }
    return out;
}

namespace {

void append(png_structp png, png_bytep data, std::size_t size) {
    auto& out = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
    out.insert(out.end(), data, data + size);
}

[[noreturn]] void fail(png_structp /*png*/, png_const_charp message) {
    throw InputError(std::string("cannot make a PNG: ") + message);
}

}  // namespace

std::vector<std::uint8_t> encode_gray_png(const GrayView& image) {
    std::vector<std::uint8_t> out;
    png_struct* const png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, nullptr);
    png_infop info = png_create_info_struct(png);
    const auto destroy = [&info](png_structp p) { png_destroy_write_struct(&p, &info); };
    const std::unique_ptr<png_struct, decltype(destroy)> owner(png, destroy);
    png_set_write_fn(png, &out, append, nullptr);
    png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
                 PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, 1);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_write_info(png, info);
    for (int y = 0; y < image.height; ++y) {
        png_write_row(png, image.pixels + static_cast<std::size_t>(y) * image.stride);
    }
    png_write_end(png, nullptr);
    return out;
}

}  // namespace crspf
