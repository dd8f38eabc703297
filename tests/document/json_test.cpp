// SPDX-License-Identifier: MIT
// One description that writes and reads, and what the reader lets in.
#include <string>

#include "document/archive/archive.hpp"
#include "document/archive/json_reader.hpp"
#include "document/archive/json_writer.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

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

namespace {

std::string refusal(const std::string& text) {
    try {
        static_cast<void>(read_json(text, "x.json", "a table"));
    } catch (const DataError& error) {
        return error.what();
    }
    return "";
}

std::string repeated(const std::string& text, std::size_t count) {
    std::string whole;
    for (std::size_t i = 0; i < count; ++i) whole += text;
    return whole;
}

}  // namespace

TEST_CASE("what the door lets in is what the library reads", "[document]") {
    for (const std::string text :
         {"null", "true", "-5", "18446744073709551615", "1.5e-3", "\"a\\u00e9\\n\"", "[]", "{}",
          "[[],{},[1]]", R"({"b": [1, {"c": null}], "a": {"b": {"b": 1}}, "": ""})", " [1 ,\n2]\t"}) {
        CHECK(read_json(text, "x.json", "x") == Json::parse(text));
        CHECK(read_json(text, "x.json", "x").dump() == Json::parse(text).dump());
    }
}

TEST_CASE("limits hold exactly", "[document]") {
    CHECK(refusal(repeated("[", max_json_depth) + repeated("]", max_json_depth)).empty());
    CHECK_THAT(refusal(repeated("[", max_json_depth + 1) + repeated("]", max_json_depth + 1)),
               Contains("x.json:1:25: read lists and objects more than 24 deep"));
    const std::string values = "[" + repeated("1,", max_json_values - 2);
    CHECK(refusal(values + "1]").empty());
    CHECK_THAT(refusal(values + "1,1]"), Contains("more than 1000000 values"));
    std::string members = "{";
    for (std::size_t i = 0; i < max_json_members; ++i) members += fmt::format("\"{}\":1,", i);
    CHECK(refusal(members.substr(0, members.size() - 1) + "}").empty());
    CHECK_THAT(refusal(members + "\"x\":1}"), Contains("an object of more than 1000 members"));
    CHECK(refusal("[1e100, -1e100]").empty());
    CHECK_THAT(refusal("[1,\n  1.1e100]"),
               Contains("x.json:2:") && Contains("read 1.1e100, expected a number"));
    CHECK_THAT(refusal("[1e400]"), Contains("read 1e400, expected a number"));
    CHECK_THAT(refusal("\"" + std::string(max_json_bytes, 'x') + "\""), Contains("bytes of JSON"));
}

TEST_CASE("a name stands once in an object, and as often as one likes in others", "[document]") {
    CHECK_THAT(refusal(R"({"a": 1, "b": 2, "a": 3})"),
               Contains("x.json:1:") && Contains("the name \"a\" for a second time"));
    CHECK_THAT(refusal(R"([{"a": 1}, {"a": {"a": 1, "a": 2}}])"), Contains("second time"));
    CHECK(refusal(R"([{"a": 1}, {"a": {"a": 1}}])").empty());
    for (const int twice : {0, 1, 15, 16, 17, 30, 98}) {
        std::string many = "{";
        for (int i = 0; i < 99; ++i) many += fmt::format("\"n{}\": 1, ", i);
        CHECK_THAT(refusal(many + fmt::format("\"n{}\": 1}}", twice)), Contains("second time"));
        CHECK(refusal(many + "\"other\": 1}").empty());
    }
}

TEST_CASE("what is no JSON is named by its place and its line", "[document]") {
    CHECK_THAT(refusal(""), Contains("read an empty file, expected a table"));
    CHECK_THAT(refusal("[1,\n 2,, 3]"), Contains("x.json:2:4: read ' 2,, 3]', which is not JSON"));
    CHECK_THAT(refusal("[1, 2"), Contains("x.json:1:"));
    CHECK_THAT(refusal("{} {}"), Contains("x.json:1:4"));
    CHECK_THAT(refusal("\"\xff\""), Contains("which is not JSON"));
}
