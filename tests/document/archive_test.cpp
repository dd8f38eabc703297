// SPDX-License-Identifier: MIT
#include "document/archive/archive.hpp"

#include "document/archive/json_reader.hpp"
#include "document/archive/json_writer.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

namespace ripplenotch {

namespace {

enum class Colour { red, green };
std::string_view colour_name(Colour colour) { return colour == Colour::red ? "red" : "green"; }

struct Part {
    double from_hz = 1.0, to_hz = 2.0;
    std::optional<double> error;
};

struct Whole {
    Colour colour = Colour::green;
    Seconds delay{0.25};
    double gain = 1.0 / 3.0;
    std::string note;
    std::vector<Part> parts = std::vector<Part>(2);
    std::vector<int> multiples = {1, 3};
    bool late = false;
};

}  // namespace

void describe(auto& archive, Is<Part> auto& part) {
    archive("range_hz", std::tie(part.from_hz, part.to_hz), lower_first);
    archive("error", part.error, above_zero_or_null);
}

void describe(auto& archive, Is<Whole> auto& whole) {
    archive("colour", whole.colour, Names{colour_name, Colour::green});
    archive("delay_ms", whole.delay, in_ms, above_zero_up_to(500.0));
    archive("gain", whole.gain, Rounded{six.json_of, true});
    archive("note", whole.note, if_any);
    archive("parts", whole.parts, AtMost{3});
    archive("multiples", whole.multiples, Limits{1.0, 9.0});
    archive("late", whole.late, if_there);
    archive.derived("sum", [&] { return whole.parts.size(); });
}

}  // namespace ripplenotch

using namespace ripplenotch;

namespace {

Whole read(const Json& json) {
    Whole whole;
    JsonReader reader(json, "w.json", "");
    describe(reader, whole);
    reader.finish();
    return whole;
}

}  // namespace

TEST_CASE("one description writes a document and reads it back") {
    const Json json = to_json(Whole{});
    CHECK(json.dump() ==
          R"({"colour":"green","delay_ms":250.0,"gain":0.333333,)"
          R"("parts":[{"range_hz":[1.0,2.0],"error":null},{"range_hz":[1.0,2.0],"error":null}],)"
          R"("multiples":[1,3],"late":false,"sum":2})");
    CHECK(to_json(read(json)) == json);
    CHECK(read(json).delay == Seconds(0.25));
    Json unknown = json;
    unknown["gain"] = nullptr;
    unknown.erase("late");
    CHECK(std::isnan(read(unknown).gain));
}

TEST_CASE("what a description does not let in is refused with the path of its field") {
    const auto says = [](const char* pointer, const Json& value, const std::string& message) {
        Json json = to_json(Whole{});
        json[Json::json_pointer(pointer)] = value;
        CHECK_THROWS_WITH(read(json), "w.json: " + message);
    };
    says("/colour", "blue", "colour is \"blue\", expected one of red, green");
    says("/delay_ms", nullptr, "delay_ms is missing");
    says("/delay_ms", "soon", "delay_ms is \"soon\", expected a number");
    says("/parts", 5, "parts is not a list");
    says("/parts", Json::array({1, 2, 3, 4}), "parts has 4 entries, expected at most 3");
    says("/parts/1", 5, "parts[1] is not an object");
    says("/parts/1/range_hz", Json::array({2, 1}),
         "parts[1].range_hz is a list, expected two numbers, the lower one first");
    says("/parts/1/error", -1, "parts[1].error is -1, expected a positive number or null");
    says("/parts/0/eror", 1, "parts[0].eror is not a known field; remove it or check its spelling");
    says("/multiples/1", 2.5, "multiples holds 2.5, expected whole numbers from 1 to 9");
    says("/late", 1, "late is not true or false");
}
