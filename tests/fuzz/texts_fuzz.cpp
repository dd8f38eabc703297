// SPDX-License-Identifier: MIT
// What stands on a command line: quantities, methods with their keys, numbers; and names, made visible. The
// first byte says which.
#include "fuzz/fuzz.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/filter/method.hpp"
#include "ripplenotch/log/layout.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fuzz;

namespace {

void quantity(std::string_view text, unsigned choice) {
    const auto dimension = static_cast<Dimension>(choice);
    static_cast<void>(answer_of([&] {
        const double value = parse_quantity(text, dimension, "--option");
        if (!is_reading(value)) fail("a quantity", text, shortest(value));
    }));
}

void spec(std::string_view text) {
    static_cast<void>(answer_of([&] {
        const Spec parsed = parse_spec(text);
        if (parse_spec(parsed.text()).text() != parsed.text())
            fail("a method written again", text, parsed.text());
        const Settings settings("method", parsed, find_method(parsed.name).keys);
    }));
}

void visible(std::string_view text) {
    const std::string shown = visible_text(text);
    if (visible_text(shown) != shown) fail("visible text acts", text, shown);
    for (const char c : shown)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            fail("visible text has control characters", text, shown);
}

void number(std::string_view text) {
    const auto number = parse_number(text);
    if (number && *number == *number && parse_number(shortest(*number)) != number)
        fail("a number written again", text, shortest(*number));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes input(data, size);
    constexpr unsigned dimensions = 11;
    switch (const unsigned choice = input.choice(dimensions + 3)) {
        case dimensions:
            spec(input.rest());
            break;
        case dimensions + 1:
            visible(input.rest());
            break;
        case dimensions + 2:
            number(input.rest());
            break;
        default:
            quantity(input.rest(), choice);
            break;
    }
    return 0;
}
