// SPDX-License-Identifier: MIT
// Links when cmake/fmt_definitions.cpp holds all that fmt's headers leave to its library.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <string>
#include <vector>

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv, argv + argc);
    const double number = argc;
    const auto whole = static_cast<std::size_t>(argc);
    fmt::memory_buffer buffer;
    fmt::format_to(std::back_inserter(buffer), "{:>{}} {:.6g} {} {:.3e} {:.2f}", words.front(), argc, number,
                   number, number, number);
    fmt::print(stderr, "{}: {}, {:+d} {:013x} {}\n", std::string_view(buffer.data(), buffer.size()),
               fmt::join(words, ", "), argc, whole, argc > 0);
    fmt::print("{} {} {:.9g}\n", 'c', static_cast<float>(number), static_cast<float>(number));
}
