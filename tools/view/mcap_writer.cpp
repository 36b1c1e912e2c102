#include "tools/view/mcap_writer.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "platform/files/atomic_file.hpp"
#include "tools/view/mcap_records.hpp"

namespace crspf::view {

struct McapWriter::State {
    State(const std::filesystem::path& path, std::span<const ChannelInfo> table)
        : file(path), channels(table.begin(), table.end()), places(table.size()), sequence(table.size()) {
        statistics.of_channel.resize(table.size());
    }

    void put(std::string_view bytes) {
        file.write(bytes);
        crc = mcap::crc(bytes, crc);
        at += bytes.size();
    }
    void end_chunk();
    void put_summary();

    AtomicFile file;
    std::vector<ChannelInfo> channels;
    std::uint64_t at = 0;    ///< bytes written
    std::uint32_t crc = 0;   ///< of them, or of the summary's
    std::string chunk;       ///< records of the one in hand
    mcap::ChunkPlace place;  ///< of the same
    bool has_messages = false;
    std::vector<std::vector<mcap::MessagePlace>> places;  ///< of its messages, by channel
    std::vector<std::uint32_t> sequence;
    std::vector<mcap::ChunkPlace> chunks;
    mcap::FileStatistics statistics;
};

void McapWriter::State::end_chunk() {
    if (!has_messages) {
        return;
    }
    has_messages = false;
    place.start = at;
    put(mcap::chunk_record(std::exchange(chunk, {}), place));
    place.length = at - place.start;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (!places[i].empty()) {
            const auto id = static_cast<std::uint16_t>(i + 1);
            place.indexes.emplace_back(id, at);
            put(mcap::message_index_record(id, std::exchange(places[i], {})));
        }
    }
    place.indexes_length = at - place.start - place.length;
    chunks.push_back(std::exchange(place, {}));
    ++statistics.chunks;
}

void McapWriter::State::put_summary() {
    std::string data_end;
    mcap::append(data_end, crc);
    std::string record;
    mcap::append_record(record, mcap::Op::kDataEnd, data_end);
    put(record);

    crc = 0;
    const std::uint64_t summary = at;
    std::string offsets;
    const auto put_group = [this, &offsets](mcap::Op op, std::string_view records) {
        if (records.empty()) {
            return;
        }
        std::string offset;
        mcap::append(offset, static_cast<std::uint8_t>(op));
        mcap::append(offset, at);
        mcap::append(offset, std::uint64_t{records.size()});
        mcap::append_record(offsets, mcap::Op::kSummaryOffset, offset);
        put(records);
    };
    put_group(mcap::Op::kSchema, mcap::schema_records(channels));
    put_group(mcap::Op::kChannel, mcap::channel_records(channels));
    put_group(mcap::Op::kStatistics, mcap::statistics_record(statistics));
    std::string chunk_indexes;
    for (const mcap::ChunkPlace& one : chunks) {
        chunk_indexes += mcap::chunk_index_record(one);
    }
    put_group(mcap::Op::kChunkIndex, chunk_indexes);
    const std::uint64_t summary_offsets = at;
    put(offsets);

    // The summary's checksum takes in the footer as far as the checksum itself.
    std::string footer;
    mcap::append(footer, static_cast<std::uint8_t>(mcap::Op::kFooter));
    mcap::append(footer, std::uint64_t{20});
    mcap::append(footer, summary);
    mcap::append(footer, summary_offsets);
    mcap::append(footer, mcap::crc(footer, crc));
    file.write(footer);
    file.write(mcap::kMagic);
}

McapWriter::McapWriter(const std::filesystem::path& file, std::span<const ChannelInfo> channels)
    : state_(std::make_unique<State>(file, channels)) {
    std::string header;
    mcap::append_text(header, "");  // no profile
    mcap::append_text(header, "crspf");
    std::string record;
    mcap::append_record(record, mcap::Op::kHeader, header);
    state_->put(mcap::kMagic);
    state_->put(record);
    state_->chunk = mcap::schema_records(state_->channels) + mcap::channel_records(state_->channels);
}

McapWriter::~McapWriter() = default;

void McapWriter::write(std::size_t channel, const Message& message) {
    State& s = *state_;
    mcap::FileStatistics& all = s.statistics;
    const auto stamp_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(message.stamp_ns, 0));
    const std::uint64_t time_ns = std::max(stamp_ns, all.last_ns);
    if (all.messages++ == 0) {
        all.first_ns = time_ns;
    }
    if (!std::exchange(s.has_messages, true)) {
        s.place.first_ns = time_ns;
    }
    all.last_ns = s.place.last_ns = time_ns;
    ++all.of_channel.at(channel);
    s.places[channel].push_back({.time_ns = time_ns, .offset = s.chunk.size()});
    s.chunk += mcap::message_record(static_cast<std::uint16_t>(channel + 1), s.sequence[channel]++, time_ns, message);
    if (s.chunk.size() >= kChunkBytes) {
        s.end_chunk();
    }
}

std::uint64_t McapWriter::messages() const {
    return state_->statistics.messages;
}

void McapWriter::finish() {
    state_->end_chunk();
    state_->put_summary();
    state_->file.commit();
}

}  // namespace crspf::view
