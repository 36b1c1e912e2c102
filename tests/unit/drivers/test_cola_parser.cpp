#include <catch2/catch.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "drivers/sick/cola_parser.hpp"
#include "drivers/sick/sick_scan.hpp"
#include "tests/unit/drivers/sick_examples.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

Bytes frame(ColaDialect dialect, std::string_view text) {
    Bytes bytes(text.size() + kColaFrame);
    bytes.resize(encode_cola(dialect, ascii(text), bytes));
    return bytes;
}

struct Heard {
    std::unique_ptr<ColaParser> parser = std::make_unique<ColaParser>();
    std::vector<std::string> texts;

    void feed(const Bytes& bytes, std::size_t piece = 1) {
        for (std::size_t at = 0; at < bytes.size(); at += piece) {
            const std::size_t n = std::min(piece, bytes.size() - at);
            parser->feed(std::span(bytes).subspan(at, n), Stamp{}, [&](const ColaTelegram& telegram, Stamp) {
                texts.emplace_back(telegram.payload.begin(), telegram.payload.end());
            });
        }
    }
};

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("cola parser: both dialects, cut anywhere") {
    Bytes stream;
    append(stream, frame(ColaDialect::kBinary, "sRA STlms 7"));
    append(stream, frame(ColaDialect::kAscii, "sAN Run 1"));
    append(stream, frame(ColaDialect::kBinary, "sEA LMDscandata 1"));
    for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
        Heard heard;
        heard.feed(stream, piece);
        CHECK(heard.texts == Texts{"sRA STlms 7", "sAN Run 1", "sEA LMDscandata 1"});
        CHECK(heard.parser->counters().bytes_skipped == 0);
    }
}

TEST_CASE("cola parser: junk is passed and counted") {
    Heard heard;
    heard.feed(hex("02 02 FF 02 02 02 02 FF FF FF FF 73 03"));
    heard.feed(hex("02"));  // one 02 too many before a header
    heard.feed(frame(ColaDialect::kBinary, "sAN Run 1"));
    heard.feed(hex("02 73 41 4E 20 01"));
    heard.feed(frame(ColaDialect::kAscii, "sAN Run 0"));
    CHECK(heard.texts == Texts{"sAN Run 1", "sAN Run 0"});
    CHECK(heard.parser->counters().bytes_skipped == 13 + 1 + 6);
    CHECK(heard.parser->counters().bad_characters == 1);
}

TEST_CASE("cola parser: a wrong sum costs that telegram only") {
    Bytes bad = frame(ColaDialect::kBinary, "sAN Run 1");
    bad.back() ^= 1;
    Heard heard;
    heard.feed(bad);
    CHECK(heard.texts.empty());
    CHECK(heard.parser->counters().bad_sums == 1);
    heard.feed(frame(ColaDialect::kBinary, "sAN Run 1"));
    CHECK(heard.texts == Texts{"sAN Run 1"});
}

TEST_CASE("cola parser: a length that is too long does not hold up what follows") {
    Bytes bad = frame(ColaDialect::kBinary, "sAN Run 1");
    bad[6] = 0x20;  // 8 KiB that will never come
    Heard heard;
    heard.feed(bad);
    heard.feed(frame(ColaDialect::kBinary, "sAN Run 2"));
    CHECK(heard.texts == Texts{"sAN Run 2"});
    CHECK(heard.parser->counters().broken_off == 1);
}

TEST_CASE("cola parser: text without an end is given up") {
    Heard heard;
    Bytes endless = ascii("\x02sSN LMDscandata ");
    endless.resize(kLargestColaPayload + 100, 'A');
    heard.feed(endless, 100);
    heard.feed(frame(ColaDialect::kAscii, "sAN Run 1"));
    CHECK(heard.texts == Texts{"sAN Run 1"});
    CHECK(heard.parser->counters().bad_characters == 1);
}

TEST_CASE("cola parser: the largest telegram fits, a larger one is not taken") {
    std::string text(kLargestColaPayload, 'A');
    text.replace(0, 10, "sRA Large ");
    for (const ColaDialect dialect : {ColaDialect::kBinary, ColaDialect::kAscii}) {
        Heard heard;
        heard.feed(frame(dialect, text), 1460);
        CHECK(heard.texts == Texts{text});
        heard.feed(frame(dialect, text + "A"), 1460);
        CHECK(heard.texts.size() == 1);
    }
}

namespace {

struct Harvest {
    int wrong = 0;  // scans passed whose values are not those sent
    int undecodable = 0;
    int right = 0;
    std::uint64_t withheld = 0;
    std::vector<bool> passed;  // by number of the telegram
    std::vector<bool> decoded;
};

// Streams `n` scans, each damaged or sound as `damage(i)` says, and compares what arrives.
template <typename Damage>
Harvest stream(ColaDialect dialect, int n, std::uint16_t beams, std::uint32_t per_mille, std::uint64_t seed,
               Damage damage) {
    Rng rng(seed);
    auto sent = std::make_unique<LmdScandata>();
    auto got = std::make_unique<LmdScandata>();
    auto parser = std::make_unique<ColaParser>();
    SickSequence sequence;
    Harvest harvest;
    harvest.passed.resize(static_cast<std::size_t>(n));
    harvest.decoded.resize(static_cast<std::size_t>(n));
    fill_tim(*sent, beams);
    const std::uint16_t first_counter = sent->telegram_counter;
    const auto value = [](std::uint32_t telegram, std::size_t i) {
        return static_cast<std::uint16_t>(std::uint64_t{telegram} * 2654435761U + i * 40503U);
    };
    for (int k = 0; k < n; ++k) {
        const auto number = static_cast<std::uint32_t>(k);
        for (std::size_t i = 0; i < std::size_t{2} * beams; ++i) {
            sent->values[i] = value(number, i);
        }
        const Bytes sound = framed(*sent, dialect);
        const Bytes bytes = damage(k) ? damaged(sound, per_mille, rng) : sound;
        parser->feed(bytes, Stamp{}, [&](const ColaTelegram& telegram, Stamp received) {
            if (!decode_lmd_scandata(telegram, *got)) {
                ++harvest.undecodable;
                return;
            }
            const auto of = static_cast<std::uint16_t>(got->telegram_counter - first_counter);
            bool same = of < n && got->channel[0].count == beams && got->channel[1].count == beams;
            for (std::size_t i = 0; same && i < std::size_t{2} * beams; ++i) {
                same = got->values[i] == value(of, i);
            }
            if (same) {
                harvest.decoded[of] = true;
            }
            if (!sequence.accept(*got, received)) {
                return;
            }
            harvest.wrong += same ? 0 : 1;
            harvest.right += same ? 1 : 0;
            if (same) {
                harvest.passed[of] = true;
            }
        });
        ++sent->telegram_counter;
        ++sent->scan_counter;
        sent->start_us += 66667;
        sent->transmit_us += 66667;
    }
    harvest.withheld = sequence.counters().withheld;
    return harvest;
}

}  // namespace

TEST_CASE("cola stream: 1 % of bytes wrong, dropped or inserted") {
    for (const ColaDialect dialect : {ColaDialect::kBinary, ColaDialect::kAscii}) {
        for (const std::uint16_t beams : {std::uint16_t{10}, std::uint16_t{811}}) {
            const int n = beams == 10 ? 20000 : 1000;
            const Harvest all = stream(dialect, n, beams, 10, 5, [](int) { return true; });
            std::printf(
                "sick: CoLa-%c, %u beams, 1 %% of bytes damaged: %d scans sent, %d right, %d wrong, %d of bad "
                "structure, %u withheld\n",
                dialect == ColaDialect::kBinary ? 'B' : 'A', static_cast<unsigned>(beams), n, all.right, all.wrong,
                all.undecodable, static_cast<unsigned>(all.withheld));
            // CoLa-B: one in 256 gets past the XOR. CoLa-A has nothing but its structure: a digit more, less or other
            // in a value is a value; few values, few damaged bytes, many of them in values.
            CHECK(all.wrong <= (dialect == ColaDialect::kBinary ? n / 1000 : n / 25));
            CHECK(all.right + all.wrong < n);  // control: the damage does harm
        }
    }
}

TEST_CASE("cola stream: sound again one telegram after damage") {
    for (const ColaDialect dialect : {ColaDialect::kBinary, ColaDialect::kAscii}) {
        // Two sound ones behind each damaged one: the second must always come.
        const int n = 6000;
        const Harvest some = stream(dialect, n, 100, 10, 7, [](int k) { return k % 3 == 2; });
        int first_lost = 0;
        int second_lost = 0;
        for (std::size_t k = 3; k + 1 < some.decoded.size(); k += 3) {
            first_lost += some.decoded[k] ? 0 : 1;
            second_lost += some.decoded[k + 1] ? 0 : 1;
        }
        std::printf(
            "sick: CoLa-%c, every third telegram damaged: of the next ones %d of %d lost, of those behind %d; "
            "%d wrong\n",
            dialect == ColaDialect::kBinary ? 'B' : 'A', first_lost, n / 3 - 1, second_lost, some.wrong);
        CHECK(second_lost == 0);
        CHECK(first_lost <= n / 3 / 50);
        CHECK(some.right > n * 6 / 10);
    }
}
