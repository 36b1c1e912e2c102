// The capture readers against public recordings whose contents are known from elsewhere.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>

#include "platform/capture/capture_reader.hpp"
#include "platform/capture/frames.hpp"
#include "tests/unit/eval/recordings.hpp"

using crspf::CanFrame;
using crspf::CaptureRecord;
using crspf::FrameContent;
using crspf::UdpDatagram;
using crspf::test::recording;

namespace {

/// Datagrams by destination port and size.
std::map<std::pair<int, std::size_t>, int> datagrams(const std::filesystem::path& file, double& length_s) {
    std::map<std::pair<int, std::size_t>, int> found;
    const auto reader = crspf::open_capture(file);
    crspf::Stamp first;
    for (CaptureRecord record; reader->next(record);) {
        UdpDatagram datagram;
        REQUIRE(udp_of(record.link, record.bytes, datagram) == FrameContent::kFound);
        ++found[{datagram.destination_port, datagram.payload.size()}];
        first = reader->counts().records == 1 ? record.stamp : first;
        length_s = (record.stamp - first).seconds();
    }
    CHECK_FALSE(reader->counts().cut_short);
    CHECK(reader->counts().unusable == 0);
    return found;
}

}  // namespace

TEST_CASE("recordings: VLP-16 and HDL-32E captures") {
    const auto vlp = recording("velodyne/mrpt_sample_velodyne_vlp16_gps.pcap");
    const auto hdl = recording("velodyne/mrpt_sample_velodyne_hdl32.pcap");
    CRSPF_NEED_RECORDING(vlp);
    CRSPF_NEED_RECORDING(hdl);
    using Found = std::map<std::pair<int, std::size_t>, int>;
    double length_s = 0.0;
    CHECK(datagrams(vlp, length_s) == Found{{{2368, 1206}, 293}, {{8308, 512}, 57}});
    CHECK(datagrams(hdl, length_s) == Found{{{2368, 1206}, 500}});
    CHECK(length_s == Approx(0.28).margin(0.01));
}

TEST_CASE("recordings: a candump log of a car") {
    const auto file = recording("can/car_imu.candump.log.xz");
    CRSPF_NEED_RECORDING(file);
    const auto reader = crspf::open_capture(file);
    std::map<std::string, int> frames;
    int imu = 0;
    for (CaptureRecord record; reader->next(record);) {
        CanFrame frame;
        REQUIRE(can_of(record.link, record.bytes, frame) == FrameContent::kFound);
        ++frames[reader->sources()[record.source].name];
        imu += frame.id == 9 && !frame.extended ? 1 : 0;
    }
    CHECK(frames == std::map<std::string, int>{{"can1", 8459}, {"can2", 65340}});
    CHECK(imu / 600.0 == Approx(101.0).margin(1.0));
    CHECK(reader->counts().unusable == 0);
}
