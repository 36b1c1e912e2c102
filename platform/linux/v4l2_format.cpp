#include "platform/linux/v4l2_format.hpp"

#include <linux/videodev2.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <vector>

namespace crspf {
namespace {

constexpr std::uint32_t kListMax = 64;  // a driver that never says "no more" must not keep us

struct PixelLayout {
    std::uint32_t code;
    std::size_t step;
    std::size_t first;
};
constexpr std::array<PixelLayout, 3> kLayouts{
    {{V4L2_PIX_FMT_GREY, 1, 0}, {V4L2_PIX_FMT_YUYV, 2, 0}, {V4L2_PIX_FMT_UYVY, 2, 1}}};

std::string name_of(std::uint32_t code) {
    std::string name;
    for (unsigned shift = 0; shift < 32; shift += 8) {
        const char letter = static_cast<char>((code >> shift) & 0x7FU);
        name += letter > ' ' && letter < '\x7F' ? letter : '?';
    }
    return name;
}

std::string text_of(int error) {
    return std::generic_category().message(error);
}

std::string size_text(std::uint32_t width, std::uint32_t height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

// NOLINTBEGIN(cppcoreguidelines-pro-type-union-access): the kernel's structs, each with the member that its type names

/// One camera, while it is asked.
class Negotiation {
 public:
    Negotiation(VideoCalls& calls, int fd, const V4l2Params& params) : calls_(calls), fd_(fd), params_(params) {}

    /// As set_v4l2_format().
    std::string run(V4l2Format& format, int& error) {
        error = EINVAL;
        if (std::string wrong = check_device(error); !wrong.empty()) {
            return wrong;
        }
        const std::vector<std::uint32_t> offered = formats();
        bool any = false;
        for (const PixelLayout& layout : kLayouts) {
            for (const std::uint32_t code : offered) {
                if (code != layout.code) {
                    continue;
                }
                any = true;
                v4l2_format granted{};
                if (!set(code, granted)) {
                    error = errno;
                    return error == EBUSY ? why_not_opened(error) : refusal(error);
                }
                if (fits(granted.fmt.pix, layout)) {
                    fill(granted.fmt.pix, layout, format);
                    return {};
                }
            }
        }
        return any ? other_size(offered) : other_format(offered);
    }

 private:
    /// False where the driver refuses, with errno.
    template <typename Argument>
    bool ask(unsigned long request, Argument& argument) {
        return calls_.ioctl(fd_, request, &argument) >= 0;
    }

    static std::string refusal(int error) {
        return "the driver refuses (" + text_of(error) + "); unplug the camera and plug it in again";
    }

    std::string check_device(int& error) {
        v4l2_capability capability{};
        if (!ask(VIDIOC_QUERYCAP, capability)) {
            const int failure = errno;
            if (failure == ENODEV) {
                error = failure;
                return why_not_opened(failure);
            }
            return "not a camera; `v4l2-ctl --list-devices` lists those there are";
        }
        const std::uint32_t can =
            (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
        if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
            return "gives no pictures (a camera has a second device for what it tells about them); try the device with "
                   "the next lower number, `v4l2-ctl --list-devices` lists them";
        }
        return {};
    }

    std::vector<std::uint32_t> formats() {
        std::vector<std::uint32_t> found;
        for (std::uint32_t i = 0; i < kListMax; ++i) {
            v4l2_fmtdesc description{};
            description.index = i;
            description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
            if (!ask(VIDIOC_ENUM_FMT, description)) {
                break;
            }
            found.push_back(description.pixelformat);
        }
        return found;
    }

    bool set(std::uint32_t code, v4l2_format& granted) {
        granted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        granted.fmt.pix.width = params_.width_px;
        granted.fmt.pix.height = params_.height_px;
        granted.fmt.pix.pixelformat = code;
        granted.fmt.pix.field = V4L2_FIELD_NONE;
        return ask(VIDIOC_S_FMT, granted);
    }

    /// A driver grants what is nearest to what it was asked for.
    [[nodiscard]] bool fits(const v4l2_pix_format& pix, const PixelLayout& layout) const {
        return pix.pixelformat == layout.code && pix.width == params_.width_px && pix.height == params_.height_px &&
               pix.field == V4L2_FIELD_NONE && pix.bytesperline >= pix.width * layout.step;
    }

    void fill(const v4l2_pix_format& pix, const PixelLayout& layout, V4l2Format& format) {
        format.width_px = pix.width;
        format.height_px = pix.height;
        format.stride = pix.bytesperline;
        format.step = layout.step;
        format.first = layout.first;
        format.picture_bytes = format.stride * (pix.height - 1) + pix.width * layout.step;
        format.rate_hz = set_rate();
    }

    /// [Hz] as granted.
    double set_rate() {
        v4l2_streamparm parameters{};
        parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        parameters.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(1e3 * params_.rate_hz))};
        const v4l2_fract& period = parameters.parm.capture.timeperframe;
        if (!ask(VIDIOC_S_PARM, parameters) || period.numerator == 0) {
            return 0.0;
        }
        return static_cast<double>(period.denominator) / static_cast<double>(period.numerator);
    }

    std::string other_format(const std::vector<std::uint32_t>& offered) const {
        std::string names;
        for (const std::uint32_t code : offered) {
            names.append(names.empty() ? "" : ", ").append(name_of(code));
        }
        return "gives " + (names.empty() ? "nothing" : names) +
               " only, and pictures must come as they are, not compressed; take a camera that gives GREY, YUYV or UYVY";
    }

    std::string other_size(const std::vector<std::uint32_t>& offered) {
        std::string sizes;
        for (const PixelLayout& layout : kLayouts) {
            for (const std::uint32_t code : offered) {
                if (code == layout.code) {
                    sizes.append(sizes.empty() ? "" : ", ").append(name_of(code)).append(sizes_of(code));
                }
            }
        }
        return "gives no whole pictures of " + size_text(params_.width_px, params_.height_px) + ", but " + sizes +
               "; choose one of these";
    }

    std::string sizes_of(std::uint32_t code) {
        std::string text;
        for (std::uint32_t i = 0; i < kListMax; ++i) {
            v4l2_frmsizeenum size{};
            size.index = i;
            size.pixel_format = code;
            if (!ask(VIDIOC_ENUM_FRAMESIZES, size)) {
                break;
            }
            if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
                text.append(" ").append(size_text(size.discrete.width, size.discrete.height));
                continue;
            }
            text.append(" ").append(size_text(size.stepwise.min_width, size.stepwise.min_height));
            text.append(" to ").append(size_text(size.stepwise.max_width, size.stepwise.max_height));
            break;  // such a list has one row
        }
        return text.empty() ? " of a size that it does not tell" : text;
    }

    VideoCalls& calls_;
    int fd_;
    const V4l2Params& params_;
};

// NOLINTEND(cppcoreguidelines-pro-type-union-access)

}  // namespace

std::string set_v4l2_format(VideoCalls& calls, int fd, const V4l2Params& params, V4l2Format& format, int& error) {
    return Negotiation(calls, fd, params).run(format, error);
}

std::string why_not_opened(int error) {
    switch (error) {
        case EACCES:
        case EPERM: return "no permission; add the user to the group and log in anew: usermod -aG video USER";
        case EBUSY: return "another program has it; `fuser -v` on the device names that, stop it";
        case ENOENT:
        case ENODEV:
        case ENXIO: return "no such camera; plug it in, `v4l2-ctl --list-devices` lists those there are";
        case ENOSPC:
            return "the USB has no room for its pictures; plug cameras into ports of different controllers, or choose "
                   "a "
                   "smaller size or rate";
        case ETIMEDOUT: return "sends no pictures any more; unplug it and plug it in again if that lasts";
        default: return text_of(error) + "; unplug the camera and plug it in again";
    }
}

}  // namespace crspf
