#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"
#include "drivers/scip/scip_codec.hpp"
#include "drivers/scip/scip_parser.hpp"
#include "drivers/scip/scip_sensor.hpp"

using namespace crspf;

namespace {

std::vector<std::uint8_t> bytes(std::string_view text) {
    return {text.begin(), text.end()};
}

// Of a real UTM-30LX.
constexpr std::string_view kCapture =
    "MD0000108004100;741478125000\n99b\n03FnG\n"
    "03E03U03U03O03K03N03L03L03P03N03O03O03P03P03U03U03V03Y03\\03b03d0E\n"
    "3e03e03e03e04\\03o04A0Zm0[90[=0oY0\\P0\\O0\\P06006803A02g02m02X02^021\n"
    "c0330340ad0b80bJ0bT0c60c=0cW0d:0`X0^W0\\;0[:0YF0X20VY0UD0TA0Rf0R=H\n"
    "0Q00PA0ON0NR02j02j03303303303302i02k02c02`02`02\\02Z02\\02\\02Z02]01\n"
    "2W02]02^02d02f02=02=0KR0IF0Hf0Gd0Fa0FU0ED0BR07E04F03;02d02a02_02H\n"
    "_02]02]02^02_02Z02\\02V02W02`02`02_02_02a02h02g03608J0:70:h0;60;[:\n"
    "0;h0<B0<O0<\\0=<0=o0>20>T0?80?I0>=0>20>W0?h0Ad0BO0AN0@h0@@0?V0?90[\n"
    ">a0>?0=\\0=P0<f0<M0<E0;i0;d0;d0<10<D0<G0<T0<b0=90=C0=S0=\\0=i0><0>K\n"
    "E0>U0?10?90?V0?h0@D0@f0AC0A\\0B70Ba0CH0Cl0D[0EJ0EM0E=0E80E50Df0D]A\n"
    "0DS0DN0Be0A_0Ac0Ae0An0AA0A70A70AE0AH0@S0@S0A20AM0A?0@d0@n0AJ0AO0N\n"
    "A[0Ae0A]0A]0AH0AG0AC0A^0BS0BA0Ad0Ab0Bc0Bb0BG0An0B10B10BE0C]0CB0BG\n"
    "o0Bi0CG0DX0Cg0D?0CT0CE0CL0F=0HJ0H[0L50LL0LW0M80MR0Mf0N20j40Uc0UL=\n"
    "0Te0So0Pi0Pi0TN0NX0M60M90MS0MM0MJ0N>0MY0MB0M;X\n\n";

constexpr std::string_view kParameters =
    "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\nAMIN:44;7\n"
    "AMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n";

}  // namespace

TEST_CASE("scip codec: the check characters of published lines") {
    for (const char* const line :
         {"VEND:Hokuyo Automatic Co.,Ltd.;[", "PROD:SOKUIKI Sensor URG-04LX;[", "FIRM:3.1.00(18/Jan./2007);`",
          "PROT:SCIP 2.0;N", "SERI:H0614967;V", "MODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N", "DMIN:20;4",
          "DMAX:5600;_", "ARES:1024;\\", "AMIN:44;7", "AMAX:725;o", "AFRT:384;6", "SCAN:600;e", "LASR:OFF;7",
          "SCSP:Initial(600[rpm])<-Default setting by user;A",
          "MESM:IDLE;:", "SBPS:19200[bps]<-Default setting by user;A", "TIME:081615;N", "STAT:Sensor works well.;8"}) {
        CAPTURE(line);
        CHECK(scip_text_line_ok(bytes(line)));
        CHECK_FALSE(scip_line_ok(bytes(line)));
        std::vector<std::uint8_t> damaged = bytes(line);
        damaged[1] ^= 1U;
        CHECK_FALSE(scip_text_line_ok(damaged));
    }
    for (const char* const line : {"00P", "99b", "0Ee", "02R", "01Q", "10Q", "03FnG"}) {
        CHECK(scip_line_ok(bytes(line)));
    }
    // Firmware that sums neither the comment nor the ';', and firmware that sums all.
    std::string line = "SBPS:19200[bps]<-Default setting by user;";
    CHECK(scip_text_line_ok(bytes(line + static_cast<char>(scip_sum(bytes("SBPS:19200[bps]"))))));
    CHECK(scip_text_line_ok(bytes(line + static_cast<char>(scip_sum(bytes(line))))));
    // Misprints of the specification.
    CHECK_FALSE(scip_text_line_ok(bytes("ARES:1024;/")));
}

TEST_CASE("scip codec: a million numbers there and back") {
    Rng rng(1);
    std::array<std::uint8_t, 4> buffer{};
    std::size_t wrong = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const std::size_t chars = 2 + rng.next() % 3;
        const std::uint32_t value = rng.next() & ((1U << (6 * chars)) - 1);
        ByteWriter out(buffer);
        scip_encode(out, value, chars);
        wrong += scip_decode(out.written()) != value || out.written().size() != chars ? 1U : 0U;
    }
    CHECK(wrong == 0);
    CHECK(scip_decode(bytes("03Fn")) == 13'758);
    CHECK(scip_decode(bytes("03E")) == 213);
    CHECK(scip_decode(bytes("0Zm")) == 2'749);
}

TEST_CASE("scip codec: requests there and back") {
    std::array<std::uint8_t, 32> buffer{};
    ByteWriter out(buffer);
    put_request(out, {ScipEncoding::kThreeChars, true, 44, 725, 1, 2, 7});
    CHECK(is_text(out.written(), "MD0044072501207"));
    ScipScanRequest request;
    CHECK(read_request(out.written(), request));
    CHECK(request == ScipScanRequest{ScipEncoding::kThreeChars, true, 44, 725, 1, 2, 7});
    CHECK(read_request(bytes("GS0044072501;text"), request));
    CHECK(request == ScipScanRequest{ScipEncoding::kTwoChars, false, 44, 725, 1, 0, 0});
    for (const char* const text :
         {"MD004407250120", "MD0044072501207x", "MX0044072501207", "GD07250044010", "MDa044072501207"}) {
        CHECK_FALSE(read_request(bytes(text), request));
    }
    CHECK(std::string(scip_status_text(bytes("10"), true)) == "laser is off");
    CHECK(std::string(scip_status_text(bytes("55"), true)) == "hardware trouble");
    CHECK(std::string(scip_status_text(bytes("33"), true)) == "stopped to verify an error");
}

TEST_CASE("scip parser: a scan of a real UTM-30LX") {
    ScipParser parser;
    ScipRanges ranges;
    int seen = 0;
    const auto visit = [&](const ScipReply& reply) {
        ScipScanRequest request;
        REQUIRE(read_request(reply.echo, request));
        CHECK(is_text(reply.status, "99"));
        CHECK(decode_scan(reply.body, request, ranges));
        request.end -= 4;
        ScipRanges refused;
        CHECK_FALSE(decode_scan(reply.body, request, refused));
        ++seen;
    };
    for (const std::uint8_t c : bytes(kCapture)) {
        parser.feed({&c, 1}, {}, visit);
    }
    REQUIRE(seen == 1);
    CHECK(ranges.stamp_ms == 13'758);
    REQUIRE(ranges.count == 271);
    const std::array<std::uint32_t, 7> first{213, 229, 229, 223, 219, 222, 220};
    CHECK(std::equal(first.begin(), first.end(), ranges.range_mm.begin()));
    CHECK(*std::min_element(ranges.range_mm.begin(), ranges.range_mm.begin() + 271) == 141);
    CHECK(*std::max_element(ranges.range_mm.begin(), ranges.range_mm.begin() + 271) == 4'073);
}

TEST_CASE("scip parser: a reply behind one that lost its blank line is found, damage is counted") {
    ScipParser parser;
    std::string text(kCapture);
    text.pop_back();  // the blank line
    text += kParameters;
    int parameters = 0;
    const auto visit = [&](const ScipReply& reply) { parameters += is_text(reply.echo, "PP") ? 1 : 0; };
    parser.feed(bytes(text), {}, visit);
    CHECK(parameters == 1);
    CHECK(parser.counters().bytes_dropped == kCapture.size() - 1);

    std::string damaged(kCapture);
    damaged[100] = damaged[100] == '0' ? '1' : '0';
    parser.feed(bytes(damaged), {}, [](const ScipReply&) { FAIL(); });
    CHECK(parser.counters().bad_sum == 2);
    parser.feed(std::vector<std::uint8_t>(20'000, 'x'), {}, [](const ScipReply&) { FAIL(); });
    CHECK(parser.counters().overflow == 1);
    parser.feed(bytes(std::string("\n\n") + std::string(kParameters)), {}, visit);
    CHECK(parameters == 2);
}

TEST_CASE("scip sensor: geometry from PP, codes, clusters") {
    ScipParser parser;
    ScipSensor sensor;
    parser.feed(bytes(kParameters), {}, [&](const ScipReply& reply) { REQUIRE(read_sensor(reply.body, sensor)); });
    CHECK(std::string(sensor.model.data()) == "URG-04LX(Hokuyo Automatic Co.,Ltd.)");
    CHECK(sensor.amin == 44);
    CHECK(sensor.amax == 725);
    CHECK(sensor.step_s() == Approx(97.66e-6).epsilon(1e-3));
    ScipRanges ranges;
    ranges.count = 5;
    ranges.range_mm = {0, 7, 19, 1'000, 5'601};
    Scan scan;
    fill_scan(ranges, {ScipEncoding::kThreeChars, true, 384, 388, 1, 0, 0}, sensor, scan);
    CHECK(scan.angle_min_rad == 0.0);
    CHECK(scan.angle_increment_rad == Approx(2.0 * kPi / 1024));
    CHECK(scan.beam[0] == Beam::kNoReturn);
    CHECK(scan.beam[1] == Beam::kInvalid);
    CHECK(scan.beam[2] == Beam::kInvalid);
    CHECK(scan.beam[3] == Beam::kHit);
    CHECK(scan.range_m[3] == 1.0F);
    CHECK(scan.beam[4] == Beam::kInvalid);
    fill_scan(ranges, {ScipEncoding::kThreeChars, true, 380, 399, 4, 0, 0}, sensor, scan);
    CHECK(scan.angle_min_rad == Approx(-2.5 * 2.0 * kPi / 1024));
    CHECK(scan.time_per_beam_s == Approx(4.0 * sensor.step_s()));
}

TEST_CASE("scip timer: unwraps 24 bits, in both directions") {
    ScipTimer timer;
    CHECK(timer.unwrap(0x7FFFFE).ns == 0x7FFFFELL * 1'000'000);
    CHECK(timer.unwrap(0xF00000).ns == 0xF00000LL * 1'000'000);
    CHECK(timer.unwrap(0xFFFFFF).ns == 0xFFFFFFLL * 1'000'000);
    CHECK(timer.unwrap(5).ns == 0x1000005LL * 1'000'000);
    CHECK(timer.unwrap(0xFFFFFE).ns == 0xFFFFFELL * 1'000'000);
}
