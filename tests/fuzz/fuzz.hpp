// SPDX-License-Identifier: MIT
#pragma once
// What the fuzz targets share: an Error of the tool is an answer, anything else that comes out ends the run.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch::fuzz {

/// Takes single bytes off the front of the input, to choose options by.
class Bytes {
  public:
    Bytes(const std::uint8_t* data, std::size_t size) : text_(reinterpret_cast<const char*>(data), size) {}
    [[nodiscard]] unsigned choice(unsigned below) {
        if (text_.empty()) return 0;
        const auto byte = static_cast<unsigned char>(text_.front());
        text_.remove_prefix(1);
        return byte % below;
    }
    [[nodiscard]] std::string_view rest() const { return text_; }

  private:
    std::string_view text_;
};

/// The message with which `work` ends; empty when it does not.
template <class Work>
std::string answer_of(Work work) {
    try {
        work();
    } catch (const Error& error) {
        if (error.code() == ExitCode::internal) throw;
        return error.what();
    }
    return "";
}

/// Ends the run with words that the log of a fuzzer shows.
[[noreturn]] void fail(std::string_view what, std::string_view one, std::string_view other);

}  // namespace ripplenotch::fuzz
