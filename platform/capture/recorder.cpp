#include "platform/capture/recorder.hpp"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <utility>

#include "platform/capture/pcapng_writer.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

constexpr std::size_t kBufferBytes = 65536;
constexpr Duration kWriteInterval{1'000'000'000};
constexpr Duration kRetryInterval{1'000'000'000};
constexpr int kNames = 100;  // of files that begin within the same second

std::string mebibytes(std::uint64_t bytes) {
    return std::to_string(bytes >> 20U) + " MiB";
}

std::string calendar(Stamp utc) {
    // Not by std::time_t, whose 32 bits on some machines end in 2038.
    using std::chrono::days;
    using std::chrono::nanoseconds;
    const std::chrono::sys_time<nanoseconds> time{nanoseconds{utc.ns}};
    const auto day = std::chrono::floor<days>(time);
    const std::chrono::year_month_day date{day};
    const std::chrono::hh_mm_ss clock{time - day};
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%04d%02u%02uT%02d%02d%02dZ", int{date.year()}, unsigned{date.month()},
                  unsigned{date.day()}, static_cast<int>(clock.hours().count()),
                  static_cast<int>(clock.minutes().count()), static_cast<int>(clock.seconds().count()));
    return text.data();
}

}  // namespace

std::uint64_t free_bytes_of(const std::filesystem::path& directory) {
    struct statvfs disk {};
    return ::statvfs(directory.c_str(), &disk) == 0 ? std::uint64_t{disk.f_bavail} * disk.f_frsize : 0;
}

Recorder::Recorder(RecorderParams params, const std::vector<CaptureSource>& sources, std::string_view comment,
                   FreeBytes free_bytes)
    : params_(std::move(params)), free_bytes_(std::move(free_bytes)), source_count_(sources.size()) {
    const std::string name = params_.directory.string();
    if (!pcapng::append_section(head_, comment)) {
        throw InputError(name + ": the comment of a recording holds up to " + std::to_string(pcapng::kTextMax) +
                         " bytes, not " + std::to_string(comment.size()) + "; shorten the configuration");
    }
    for (const CaptureSource& source : sources) {
        if (!pcapng::append_source(head_, source)) {
            throw InputError(name + ": source " + source.name + " cannot be recorded; give it a kind and a short name");
        }
    }
    if (::access(params_.directory.c_str(), W_OK | X_OK) != 0) {
        throw InputError(name + ": cannot be recorded into: " + std::generic_category().message(errno) +
                         "; name a directory that you may write to");
    }
    if (!has_space()) {
        throw InputError(problem_);
    }
    buffer_.reserve(2 * kBufferBytes);
}

Recorder::~Recorder() {
    static_cast<void>(flush());
}

bool Recorder::append(std::uint32_t source, Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes) {
    latest_ = stamp;
    const CaptureRecord record{.source = source,
                               .link = LinkKind::kOther,
                               .direction = direction,
                               .cut = false,
                               .stamp = stamp + params_.utc_minus_stamp,
                               .bytes = bytes};
    const std::size_t before = buffer_.size();
    if (source >= source_count_ || !pcapng::append_record(buffer_, record)) {
        ++counters_.refused;
        return false;
    }
    const std::size_t size = buffer_.size() - before;
    bool good = true;
    const bool full = fd_.valid() && file_bytes_ + buffer_.size() > params_.file_bytes_max;
    const bool old = fd_.valid() && stamp - file_begin_ >= params_.file_time_max;
    if (full || old) {
        const std::vector<std::uint8_t> block(buffer_.end() - static_cast<std::ptrdiff_t>(size), buffer_.end());
        buffer_.resize(before);
        good = end_file();
        buffer_ = block;
    }
    if (!fd_.valid() && (stamp < retry_ || !start_file(stamp))) {
        buffer_.clear();
        ++counters_.lost;
        return false;
    }
    ++buffered_records_;
    if (buffer_.size() >= kBufferBytes || stamp - last_write_ >= kWriteInterval) {
        good = write_out() && good;
    }
    if (fd_.valid() && stamp - last_sync_ >= params_.sync_interval) {
        good = sync() && good;
    }
    return good;
}

bool Recorder::flush() {
    return write_out() && sync();
}

bool Recorder::has_space() {
    const std::uint64_t free_bytes = free_bytes_(params_.directory);
    if (free_bytes >= params_.free_bytes_min) {
        return true;
    }
    problem_ = params_.directory.string() + ": " + mebibytes(free_bytes) + " free, of which " +
               mebibytes(params_.free_bytes_min) + " are to stay so; free some space or record elsewhere";
    return false;
}

/// The block of the first record is in the buffer already; the head goes before it.
bool Recorder::start_file(Stamp stamp) {
    retry_ = stamp + kRetryInterval;
    if (!has_space()) {
        return false;
    }
    const std::string stem = params_.prefix + "-" + calendar(stamp + params_.utc_minus_stamp);
    int error = EEXIST;
    for (int i = 0; i < kNames && error == EEXIST; ++i) {
        std::string name = stem;
        if (i > 0) {
            name.append("-").append(std::to_string(i));
        }
        file_ = params_.directory / name.append(".pcapng");
        fd_ = UniqueFd(::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
        error = fd_.valid() ? 0 : errno;
    }
    if (error != 0) {
        fail(file_, error);
        file_.clear();
        return false;
    }
    ++counters_.files;
    problem_.clear();
    retry_ = kAnyTime;
    buffer_.insert(buffer_.begin(), head_.begin(), head_.end());
    file_bytes_ = 0;
    file_begin_ = last_write_ = last_sync_ = stamp;
    const UniqueFd directory(::open(params_.directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (directory.valid()) {
        static_cast<void>(::fsync(directory.get()));  // its name survives a power cut, where the file system can
    }
    return true;
}

bool Recorder::end_file() {
    const bool written = write_out() && sync();
    if (!fd_.valid()) {
        return false;
    }
    file_.clear();
    fd_ = UniqueFd();
    return written;
}

bool Recorder::write_out() {
    if (!fd_.valid()) {
        return buffer_.empty();
    }
    last_write_ = latest_;
    std::span<const std::uint8_t> rest = buffer_;
    while (!rest.empty()) {
        const ssize_t written = ::write(fd_.get(), rest.data(), rest.size());
        if (written >= 0) {
            rest = rest.subspan(static_cast<std::size_t>(written));
        } else if (errno != EINTR) {
            fail(file_, errno);
            pause();
            return false;
        }
    }
    file_bytes_ += buffer_.size();
    counters_.written += std::exchange(buffered_records_, 0);
    const bool any = !buffer_.empty();
    buffer_.clear();
    if (any && !has_space()) {
        static_cast<void>(sync());
        pause();
        return false;
    }
    return true;
}

bool Recorder::sync() {
    last_sync_ = latest_;
    if (fd_.valid() && ::fdatasync(fd_.get()) != 0) {
        fail(file_, errno);
        pause();
        return false;
    }
    return true;
}

void Recorder::fail(const std::filesystem::path& path, int error) {
    problem_ = path.string() + ": cannot be written: " + std::generic_category().message(error) +
               "; check the disk or record elsewhere";
}

/// Gives up the file with what is on the disk, and the buffer.
void Recorder::pause() {
    if (fd_.valid()) {
        // A part of a block may have got through. Where it cannot be cut off either, readers pass over it.
        static_cast<void>(::ftruncate(fd_.get(), static_cast<off_t>(file_bytes_)));
    }
    fd_ = UniqueFd();
    file_.clear();
    counters_.lost += std::exchange(buffered_records_, 0);
    buffer_.clear();
    retry_ = latest_ + kRetryInterval;
}

}  // namespace crspf
