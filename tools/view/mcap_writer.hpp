// Messages of channels as an MCAP file (mcap.dev/spec, version 0): in chunks, compressed, with an index and checksums.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "tools/view/channels.hpp"

namespace crspf::view {

/// The file appears whole or not at all, at finish(). Memory: one chunk, and 200 bytes for each that was written.
/// Throws InputError for a file that cannot be written.
class McapWriter {
 public:
    static constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;  ///< and the message that goes beyond

    McapWriter(const std::filesystem::path& file, std::span<const ChannelInfo> channels);
    McapWriter(const McapWriter&) = delete;
    McapWriter& operator=(const McapWriter&) = delete;
    ~McapWriter();

    /// In the order in which they are to be played: a message never stands at an earlier time than the one before it.
    /// Its own stamp is kept as the time of publishing.
    /// @param channel place in `channels`
    void write(std::size_t channel, const Message& message);
    [[nodiscard]] std::uint64_t messages() const;
    /// The last call.
    void finish();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace crspf::view
