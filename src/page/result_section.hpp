// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "document/json/json.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

// What the top of a page says of a result: the question, an answer in a sentence, and its numbers.

/// What a person asked who got this kind of result; the kind itself where none is known.
[[nodiscard]] std::string question_of(const std::string& kind);

/// The answer of a kind that carries no verdict of its own, made of its numbers; empty where there are none.
[[nodiscard]] std::string sentence_of(const std::string& kind, const Json& result);

/// At most three numbers, with units, that answer the question.
[[nodiscard]] std::vector<PageFact> key_numbers(const std::string& kind, const Json& result);

}  // namespace ripplenotch
