#include <catch2/catch.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/can/dbc_lookup.hpp"
#include "drivers/can/dbc_reader.hpp"

using namespace crspf;

namespace {

constexpr std::string_view kText =
    "\xEF\xBB\xBFVERSION \"1.0\"\r\n\r\nNS_ :\n\tNS_DESC_\n\tCM_\n\tBA_DEF_\n\tSG_MUL_VAL_\n\nBS_: 500:1,2\n\nBU_: A "
    "node-2\n\nVAL_TABLE_ OnOff 1 \"on; \\\"really\\\"\" 0 \"off\" ;\n"
    "BO_ 496 Example: 8 A\n"
    " SG_ Temperature : 0|12@0- (0.01,250) [229.52|270.47] \"degK\" node-2,A\n"
    " SG_ AverageRadius : 6|6@0+ (0.1,0) [0|5] \"m\" node-2\n"
    " SG_ Enable : 7|1@0+ (1,0) [0|0] \"-\" Vector__XXX\n\n"
    "BO_ 2566844926 CCVS1: 8 Vector__XXX\n"
    " SG_ Speed : 8|16@1+ (+0.00390625,-0) [0|2.50996E+002] \"km/h; \\\"x\\\"\" Vector__XXX\n"
    "BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n SG_ Nowhere : 0|8@1+ (1,0) [0|0] \"\" Vector__XXX\n"
    "BO_ 256 Floats: 8 A\n SG_ F : 0|32@1- (1,0) [0|0] \"\" A\n SG_ G : 32|32@1- (1,0) [0|0] \"\" A\n"
    "BO_ 257 Short: 8 A\n SG_ F : 0|16@1- (1,0) [0|0] \"\" A\n"
    "BO_ 300 Mux: 8 A\n SG_ a m1 : 8|8@1+ (1,0) [0|0] \"\" A\n SG_ S M : 0|8@1+ (1,0) [0|0] \"\" A\n"
    " SG_ b m2 : 8|8@1+ (1,0) [0|0] \"\" A\n SG_ M : 16|8@1+ (1,0) [0|0] \"\" A\n"
    "BO_ 301 Nested: 8 A\n SG_ S M : 0|8@1+ (1,0) [0|0] \"\" A\n SG_ T m1M : 8|8@1+ (1,0) [0|0] \"\" A\n"
    " SG_ c m1 : 16|8@1+ (1,0) [0|0] \"\" A\n"
    "CM_ \"of the\nbus: BO_ 1 x: 8 y\";\nCM_ SG_ 496 Enable \"a \\\"quoted\\\" word\";\n"
    "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_ \"GenMsgCycleTime\" BO_ 496 10;\n"
    "EV_ Env: 0 [0|0] \"\" 0 1 DUMMY_NODE_VECTOR0 Vector__XXX;\n"
    "VAL_ 496 Enable 1 \"on\" 0 \"off\" ;\nSIG_VALTYPE_ 256 F : 1;\nSIG_VALTYPE_ 257 F : 1;\n"
    "SG_MUL_VAL_ 300 b S 2-2, 4-6, 9 - 9;\n";

CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> bytes, bool extended = false) {
    CanFrame out{.id = id, .extended = extended, .length = static_cast<std::uint8_t>(bytes.size())};
    std::copy(bytes.begin(), bytes.end(), out.data.begin());
    return out;
}

DbcError error_of(std::string_view text) {
    DbcReader reader(text);
    while (true) {
        const DbcReader::Item item = reader.next();
        if (item == DbcReader::Item::kError) {
            REQUIRE(reader.next() == DbcReader::Item::kError);
            return reader.error();
        }
        if (item == DbcReader::Item::kEnd) {
            REQUIRE(reader.next() == DbcReader::Item::kEnd);
            return {};
        }
    }
}

}  // namespace

TEST_CASE("dbc: every message and signal, in order") {
    DbcReader reader(kText);
    std::string seen;
    for (DbcReader::Item item = reader.next(); item != DbcReader::Item::kEnd; item = reader.next()) {
        if (item == DbcReader::Item::kError) {
            FAIL(reader.error().line << ':' << reader.error().column << ' ' << reader.error().reason);
        } else if (item == DbcReader::Item::kMessage) {
            seen.append(reader.message().name).append(": ");
        } else if (item == DbcReader::Item::kSignal) {
            seen.append(reader.signal().name).append(" ");
        }
    }
    CHECK(seen ==
          "Example: Temperature AverageRadius Enable CCVS1: Speed Floats: F G Short: F Mux: a S b M "
          "Nested: S T c ");
}

TEST_CASE("dbc: a signal by its name") {
    const DbcLookup temperature = find_signal(kText, "Example", "Temperature");
    REQUIRE(temperature.status == DbcLookup::Status::kFound);
    CHECK(temperature.unit == "degK");
    CHECK(temperature.signal.layout.minimum == 229.52);
    CHECK(value_in(temperature.signal, frame(496, {0xC0, 0x06, 0xE0, 0, 0, 0, 0, 0})) == Approx(250.55));
    CHECK_FALSE(value_in(temperature.signal, frame(497, {0xC0, 0x06, 0xE0})).has_value());
    CHECK_FALSE(value_in(temperature.signal, frame(496, {0xC0, 0x06, 0xE0}, true)).has_value());
    CHECK_FALSE(value_in(temperature.signal, frame(496, {0xC0})).has_value());

    DbcLookup speed = find_signal(kText, "CCVS1", "Speed");
    REQUIRE(speed.status == DbcLookup::Status::kFound);
    CHECK(speed.signal.extended);
    CHECK(speed.signal.id == 0x18FEF1FE);
    const std::vector<std::uint8_t> kmh{0, 0x00, 0x0A, 0, 0, 0, 0, 0};
    CHECK(value_in(speed.signal, frame(0x18FEF1FE, kmh, true)) == 10.0);
    CHECK_FALSE(value_in(speed.signal, frame(0x0CFEF100, kmh, true)).has_value());
    speed.signal.id_mask = kJ1939PgnMask;  // whatever the sender's address and priority
    CHECK(value_in(speed.signal, frame(0x0CFEF100, kmh, true)) == 10.0);
    CHECK_FALSE(value_in(speed.signal, frame(0x0CFEF200, kmh, true)).has_value());

    CHECK(find_signal(kText, "Floats", "F").signal.layout.type == SignalType::kFloat32);
    CHECK(find_signal(kText, "Floats", "G").signal.layout.type == SignalType::kSigned);
    CHECK(find_signal(kText, "Short", "F").status == DbcLookup::Status::kFloat);
    CHECK(find_signal(kText, "Exampl", "Enable").status == DbcLookup::Status::kNoMessage);
    CHECK(find_signal(kText, "Example", "Speed").status == DbcLookup::Status::kNoSignal);
    CHECK(find_signal(kText, "VECTOR__INDEPENDENT_SIG_MSG", "Nowhere").status == DbcLookup::Status::kNoMessage);
}

TEST_CASE("dbc: multiplexed signals are in the frame only while they are selected") {
    const DbcLookup a = find_signal(kText, "Mux", "a");
    REQUIRE(a.status == DbcLookup::Status::kFound);
    CHECK(value_in(a.signal, frame(300, {1, 42, 0})) == 42.0);
    CHECK_FALSE(value_in(a.signal, frame(300, {2, 42, 0})).has_value());
    const DbcLookup b = find_signal(kText, "Mux", "b");
    REQUIRE(b.status == DbcLookup::Status::kFound);
    for (const unsigned selector : {2U, 4U, 5U, 6U, 9U}) {
        CHECK(value_in(b.signal, frame(300, {static_cast<std::uint8_t>(selector), 42, 0})) == 42.0);
    }
    for (const unsigned selector : {0U, 1U, 3U, 7U, 8U, 10U}) {
        CHECK_FALSE(value_in(b.signal, frame(300, {static_cast<std::uint8_t>(selector), 42, 0})).has_value());
    }
    CHECK(value_in(find_signal(kText, "Mux", "S").signal, frame(300, {7, 42, 0})) == 7.0);
    CHECK(value_in(find_signal(kText, "Mux", "M").signal, frame(300, {7, 42, 9})) == 9.0);
    CHECK(find_signal(kText, "Nested", "c").status == DbcLookup::Status::kMultiplex);
    CHECK(find_signal(kText, "Nested", "S").status == DbcLookup::Status::kFound);
}

TEST_CASE("dbc: an error names its line, its column and its reason") {
    struct Example {
        std::string text;
        std::size_t line;
        std::size_t column;
        std::string_view reason;
    };
    const std::string head = "BU_: A\nBO_ 1 x: 8 A\n";
    std::string long_name = head;
    long_name.append(" SG_ ").append(129, 'n').append(" : 0|8@1+ (1,0) [0|0] \"\" A");
    for (const Example& e : std::vector<Example>{
             {head + " SG_ s : 0|12@2- (1,0) [0|0] \"\" A", 3, 15, "byte order"},
             {head + " SG_ s : 60|12@1- (1,0) [0|0] \"\" A", 3, 10, "beyond its message"},
             {head + " SG_ s : 0|65@1- (1,0) [0|0] \"\" A", 3, 10, "more than 64"},
             {head + " SG_ s : 0|0@1- (1,0) [0|0] \"\" A", 3, 10, "no bits"},
             {head + " SG_ s : 0|8@1 (1,0) [0|0] \"\" A", 3, 16, "sign"},
             {head + " SG_ s : 0|8@1+ (1;0) [0|0] \"\" A", 3, 19, "','"},
             {head + " SG_ s : 0|8@1+ (1e999,0) [0|0] \"\" A", 3, 18, "number"},
             {head + " SG_ s : 0|8@1+ (1,0) [0|0] \"open", 3, 29, "never closed"},
             {head + " SG_ s x : 0|8@1+ (1,0) [0|0] \"\" A", 3, 8, "m<number>"},
             {head + " SG_ s m1x : 0|8@1+ (1,0) [0|0] \"\" A", 3, 8, "m<number>"},
             {long_name, 3, 6, "128"},
             {"SG_ s : 0|8@1+ (1,0) [0|0] \"\" A", 1, 1, "outside of a message"},
             {"BO_ 2048 x: 8 A", 1, 5, "11"},
             {"BO_ 4294967295 x: 8 A", 1, 5, "29"},
             {"BO_ 99999999999 x: 8 A", 1, 5, "message id"},
             {"BO_ 1 x: 1786 A", 1, 10, "1785"},
             {"CM_ \"never ended\"", 1, 18, "';'"},
             {"\n\nnonsense", 3, 1, "keyword"},
             {"SIG_VALTYPE_ 1 s : 3;", 1, 20, "value type"},
             {"SG_MUL_VAL_ 1 s m 5-3;", 1, 20, "ends before"},
         }) {
        INFO(e.text);
        const DbcError error = error_of(e.text);
        REQUIRE(error.reason != nullptr);
        CHECK_THAT(std::string(error.reason), Catch::Contains(std::string(e.reason)));
        CHECK(error.line == e.line);
        CHECK(error.column == e.column);
        CHECK(find_signal(e.text, "x", "s").status == DbcLookup::Status::kBadText);
    }
    const std::string good = head + " SG_ " + std::string(128, 'n') + " : 0|8@1+ (1,0) [0|0] \"\" A";
    CHECK(error_of(good).reason == nullptr);
    CHECK(error_of("").reason == nullptr);
}
