// SPDX-License-Identifier: MIT
#include "fuzz/mutate_json.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

namespace ripplenotch::fuzz {
namespace {

using Json = nlohmann::ordered_json;
using Random = std::mt19937;

constexpr std::array numbers = {0.0,
                                -0.0,
                                -1.0,
                                1.0,
                                2.0,
                                0.5,
                                1e-320,
                                1e-300,
                                1e99,
                                -1e99,
                                1e100,
                                1e300,
                                2147483648.0,
                                9007199254740992.0,
                                1.8446744073709552e19,
                                255.0,
                                1e6,
                                0.1,
                                1e-9,
                                1e9};
constexpr std::array texts = {"",     "nan",     "\x1b]0;x\x07",       "a\nb", "</script>", "order",
                              "pass", "digital", "ripplenotch/table/1"};

unsigned below(Random& random, std::size_t most) { return static_cast<unsigned>(random() % most); }

void collect(Json& json, std::vector<Json*>& into) {
    into.push_back(&json);
    if (!json.is_structured()) return;
    for (Json& child : json) collect(child, into);
}

Json anything(Random& random) {
    switch (below(random, 8)) {
        case 0:
            return nullptr;
        case 1:
            return random() % 2 == 0;
        case 2:
            return Json::array();
        case 3:
            return Json::object();
        case 4:
            return texts[below(random, texts.size())];
        case 5:
            return Json::array({nullptr, Json::object()});
        default:
            return numbers[below(random, numbers.size())];
    }
}

void change(Json& json, const Json& donor, Random& random) {
    const unsigned way = below(random, 10);
    if (way < 2 && json.is_number()) {
        json = json.get<double>() * (way == 0 ? -1.0 : 0.5 + 0.01 * below(random, 100));
    } else if (way == 2 && json.is_array() && !json.empty() && json.size() < 200) {
        const Json once = json;
        for (const Json& entry : once) json.push_back(entry);
    } else if (way == 3 && json.is_structured() && !json.empty()) {
        auto at = json.begin();
        std::advance(at, below(random, json.size()));
        json.erase(at);
    } else if (way == 4 && json.is_object()) {
        json["unknown"] = anything(random);
    } else if (way == 5) {
        json = donor;
    } else if (way == 6) {
        for (unsigned depth = below(random, 40); depth > 0; --depth) json = Json::array({json});
    } else if (way == 7 && json.is_array() && json.size() > 1) {
        std::swap(json[0], json[below(random, json.size())]);
    } else {
        json = anything(random);
    }
}

}  // namespace

std::string mutated_json(std::string_view text, unsigned seed) {
    constexpr std::size_t most_nodes = 20000;
    Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) return "";
    Random random(seed);
    for (unsigned changes = 1 + below(random, 3); changes > 0; --changes) {
        std::vector<Json*> nodes;
        collect(json, nodes);
        if (nodes.size() > most_nodes) return "";
        const Json donor = *nodes[below(random, nodes.size())];
        change(*nodes[below(random, nodes.size())], donor.size() < 50 ? donor : Json(nullptr), random);
    }
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace ripplenotch::fuzz
