// SPDX-License-Identifier: MIT
#include "document/json/json.hpp"

#include <string>

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

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
