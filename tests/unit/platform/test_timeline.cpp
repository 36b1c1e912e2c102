#include "platform/capture/timeline.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

using crspf::Stamp;
using crspf::Timeline;
using Source = crspf::Timeline::Source;

namespace {

constexpr Source kLaser = Source::kScan;
constexpr Source kOdometry = Source::kOdometry;

constexpr std::int64_t ms(std::int64_t value) {
    return value * 1'000'000;
}

/// Ten stamps 125 ms apart, the first at `start_s`.
Timeline after_ten(double start_s) {
    Timeline line;
    for (int i = 0; i < 10; ++i) {
        line.place(kLaser, start_s + 0.125 * i);
    }
    return line;
}
constexpr std::int64_t kAfterTen = 9 * 125'000'000LL;

}  // namespace

TEST_CASE("timeline: starts at 0, whatever the first stamp") {
    for (const double start_s : {0.0, -5.0, 976052857.33753, 1e300}) {
        Timeline line;
        CHECK(line.place(kLaser, start_s).ns == 0);
        CHECK(line.jumps() == 0);
    }
}

TEST_CASE("timeline: believable stamps keep their differences") {
    Timeline line;
    line.place(kLaser, 1000.0);
    CHECK(line.place(kLaser, 1000.25).ns == ms(250));
    CHECK(line.place(kOdometry, 1000.5).ns == ms(500));
    CHECK(line.place(kLaser, 1060.5).ns == ms(60500));  // a pause of just kGapMax_s
    CHECK(line.jumps() == 0);
}

TEST_CASE("timeline: equal stamps are fine") {
    Timeline line;
    line.place(kLaser, 5.0);
    CHECK(line.place(kLaser, 5.0).ns == 0);
    CHECK(line.jumps() == 0);
}

TEST_CASE("timeline: a stamp that runs back moves the line by the typical interval") {
    Timeline line = after_ten(100.0);
    CHECK(line.place(kLaser, 50.0).ns == kAfterTen + ms(125));
    CHECK(line.jumps() == 1);
    SECTION("and the next goes on from there") {
        CHECK(line.place(kLaser, 50.25).ns == kAfterTen + ms(125 + 250));
        CHECK(line.jumps() == 1);
    }
}

TEST_CASE("timeline: a stamp that leaps ahead moves the line by the typical interval, there and back") {
    Timeline line = after_ten(100.0);
    CHECK(line.place(kLaser, 1e9).ns == kAfterTen + ms(125));
    CHECK(line.place(kLaser, 101.5).ns == kAfterTen + ms(250));
    CHECK(line.jumps() == 2);
}

TEST_CASE("timeline: the typical interval is a median and follows the latest stamps") {
    Timeline line;
    double t = 0.0;
    for (int i = 0; i < 40; ++i) {
        line.place(kLaser, t += i % 4 == 0 ? 30.0 : 0.125);  // every fourth is an outlier
    }
    const Stamp before = line.place(kLaser, t);
    CHECK((line.place(kLaser, 0.0) - before).ns == ms(125));
    t = 0.0;
    for (int i = 0; i < 63; ++i) {
        line.place(kLaser, t += 0.5);
    }
    const Stamp later = line.place(kLaser, t);
    CHECK((line.place(kLaser, 0.0) - later).ns == ms(500));
}

TEST_CASE("timeline: each source has its own typical interval, counted from its own last stamp") {
    Timeline line;
    for (int i = 0; i <= 100; ++i) {
        line.place(kOdometry, i * 0.015625);
        if (i % 20 == 0) {
            line.place(kLaser, i * 0.015625);
        }
    }
    for (int i = 101; i <= 119; ++i) {
        line.place(kOdometry, i * 0.015625);
    }
    // The laser's turn comes 20 odometry intervals after its last; 19 have gone by.
    CHECK(line.place(kLaser, 0.0).ns == static_cast<std::int64_t>(120 * 0.015625 * 1e9));
    CHECK(line.place(kOdometry, -5.0).ns == static_cast<std::int64_t>(120 * 0.015625 * 1e9));
    CHECK(line.jumps() == 2);
}

TEST_CASE("timeline: before any interval is known, a jump leaves the line where it is") {
    Timeline line;
    line.place(kLaser, 10.0);
    CHECK(line.place(kLaser, 5.0).ns == 0);
    CHECK(line.place(kOdometry, 1.0).ns == 0);
    CHECK(line.jumps() == 2);
}

TEST_CASE("timeline: a scan that is written after newer odometry keeps its stamp") {
    Timeline line;
    line.place(kOdometry, 500.0);
    for (int i = 1; i <= 8; ++i) {
        CHECK(line.place(kOdometry, 500.0 + 0.125 * i).ns == ms(125) * i);
        CHECK(line.place(kLaser, 500.0 + 0.125 * i - 0.25).ns == ms(125) * i - ms(250));
    }
    CHECK(line.jumps() == 0);
}

TEST_CASE("timeline: a scan older than the first stamp stands before 0") {
    Timeline line;
    line.place(kOdometry, 500.0);
    CHECK(line.place(kLaser, 499.75).ns == ms(-250));
    CHECK(line.place(kOdometry, 500.125).ns == ms(125));
    CHECK(line.jumps() == 0);
}

TEST_CASE("timeline: so may odometry be written after a newer scan") {
    Timeline line;
    line.place(kOdometry, 500.0);
    line.place(kLaser, 500.25);
    CHECK(line.place(kOdometry, 500.125).ns == ms(125));
    CHECK(line.place(kLaser, 500.5).ns == ms(500));
    CHECK(line.jumps() == 0);
}

TEST_CASE("timeline: how late a scan may be") {
    Timeline line;
    for (int i = 0; i <= 20; ++i) {
        line.place(kOdometry, 500.0 + 0.125 * i);
    }
    SECTION("just so") {
        CHECK(line.place(kLaser, 502.5 - Timeline::kLateMax_s).ns == ms(1500));
        CHECK(line.jumps() == 0);
    }
    SECTION("more is a jump") {
        CHECK(line.place(kLaser, 502.375 - Timeline::kLateMax_s).ns == ms(2500));
        CHECK(line.jumps() == 1);
    }
}

TEST_CASE("timeline: a source that runs back against itself jumps, be it ever so little") {
    Timeline line;
    line.place(kOdometry, 500.0);
    line.place(kOdometry, 500.5);
    line.place(kLaser, 500.25);
    SECTION("scans, and not to behind the newest stamp") {
        CHECK(line.place(kLaser, 500.125).ns == ms(500));
    }
    SECTION("odometry") {
        CHECK(line.place(kOdometry, 500.375).ns == ms(1000));
    }
    CHECK(line.jumps() == 1);
}

TEST_CASE("timeline: one clock for both sources: after a jump of one, the other goes on from there") {
    Timeline line;
    for (int i = 0; i <= 8; ++i) {
        line.place(kOdometry, 500.0 + 0.125 * i);
        line.place(kLaser, 500.0 + 0.125 * i - 0.0625);
    }
    CHECK(line.place(kOdometry, 100.0).ns == ms(1125));
    CHECK(line.place(kLaser, 99.9375).ns == 1'062'500'000);
    CHECK(line.place(kOdometry, 100.125).ns == ms(1250));
    CHECK(line.jumps() == 1);
}

TEST_CASE("timeline: equal stamps stay equal to the nanosecond, also where the sources alternate") {
    Timeline line;
    const double start_s = 976052857.33753;
    line.place(kOdometry, start_s);
    double t = start_s;
    for (int i = 0; i < 1000; ++i) {
        t += 0.0123456789 * (1 + i % 7);
        const Stamp odometry = line.place(kOdometry, t);
        REQUIRE(line.place(kLaser, t) == odometry);
    }
    CHECK((line.place(kLaser, t) - Stamp{}).seconds() == Approx(t - start_s).epsilon(0.0).margin(1e-9));
    CHECK(line.jumps() == 0);
}

TEST_CASE("timeline: a leap that was believed stays when the stamps run back") {
    Timeline line = after_ten(100.0);
    CHECK(line.place(kLaser, 131.125).ns == kAfterTen + ms(30000));
    CHECK(line.place(kLaser, 101.375).ns == kAfterTen + ms(30125));
    CHECK(line.place(kLaser, 101.5).ns == kAfterTen + ms(30250));
    CHECK(line.jumps() == 1);
}

TEST_CASE("timeline: no source ever runs back, nor behind the line by more than kLateMax_s, whatever the stamps") {
    Timeline line;
    std::uint64_t state = 12345;
    const std::vector<double> steps{-1e300, -61.0, -1.0, -0.1, -1e-9, 0.0, 1e-9, 0.125, 59.0, 61.0, 1e18, 1e300};
    double t = 0.0;
    std::array<Stamp, 2> before{Stamp{-ms(1000)}, Stamp{-ms(1000)}};
    Stamp newest;
    bool late = false;
    for (int i = 0; i < 20000; ++i) {
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        const auto step = steps.begin() + static_cast<std::ptrdiff_t>((state >> 33U) % steps.size());
        const double next = t + *step;
        t = next > -1e300 && next < 1e300 ? next : 0.0;
        const std::size_t source = state >> 63U == 0 ? 0 : 1;
        const Stamp now = line.place(static_cast<Source>(source), t);
        REQUIRE(now >= before[source]);
        REQUIRE(now - newest >= crspf::Duration::from_seconds(-Timeline::kLateMax_s));
        REQUIRE(now - newest <= crspf::Duration::from_seconds(120.0));
        late = late || now < newest;
        before[source] = now;
        newest = std::max(newest, now);
    }
    CHECK(late);
    CHECK(line.jumps() > 0);
}
