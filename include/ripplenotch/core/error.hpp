// SPDX-License-Identifier: MIT
#pragma once
// Throw when the user's request cannot be carried out; return a value when the answer is "no". Five types,
// one helper, one catch in main. A message says what, the value, the limit, and the remedy.

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace ripplenotch {

/// Exit codes of the tool; see docs/commands/README.md.
enum class ExitCode : int {
    done = 0,
    limit_violated = 1,
    usage = 2,
    data = 3,
    file = 4,
    inconclusive = 5,
    memory = 6,
    internal = 70,
};

class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    [[nodiscard]] ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

/// The request itself is wrong: an option, a specification, a design that cannot exist.
class UsageError : public Error {
  public:
    explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};

/// A log or a document says something that cannot be used. The message names file, line and column.
class DataError : public Error {
  public:
    explicit DataError(const std::string& message) : Error(ExitCode::data, message) {}
};

/// A file cannot be opened, read, written or replaced.
class FileError : public Error {
  public:
    explicit FileError(const std::string& message) : Error(ExitCode::file, message) {}
};

/// raise<DataError>("{}:{}: ...", file, line) formats and throws.
template <class E, class... Args>
[[noreturn]] void raise(fmt::format_string<Args...> format, Args&&... args) {
    throw E(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace ripplenotch
