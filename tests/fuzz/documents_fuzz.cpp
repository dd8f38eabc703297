// SPDX-License-Identifier: MIT
// Documents: tables, models, joints, figures, diagnoses, each by its own reader, and any result as a page.
// Bytes are changed by libFuzzer, the structure by tests/fuzz/mutate_json.cpp. The size says which reader: a
// byte in front would be no JSON.
#include <array>
#include <string>

#include "fuzz/fuzz.hpp"
#include "fuzz/mutate_json.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/page/page.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fuzz;

namespace {

void table(const std::string& text) {
    const CandidateTable table = table_from_json(text, "x");
    static_cast<void>(table_from_json(table_to_json(table, {}, {}), "again"));
}

void model(const std::string& text) { static_cast<void>(read_model_with_given(text, "x")); }

void joint(const std::string& text) {
    const Identification found = identification_from_json(text, "x");
    static_cast<void>(identification_from_json(identification_text(found, {}), "again"));
}

void page(const std::string& text) {
    const Page page{"title", {section_of_result(text, "x")}};
    const std::string html = html_page(page, "// no plotly.js");
    if (html.find('\x1b') != std::string::npos) fail("a page with an escape", text, html);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    constexpr std::array readers = {table, model, joint, page};
    static_cast<void>(answer_of([&] { readers[size % readers.size()](text); }));
    return 0;
}

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
    if (seed % 4 != 0) {
        const std::string text = mutated_json({reinterpret_cast<const char*>(data), size}, seed);
        if (!text.empty() && text.size() <= most) {
            text.copy(reinterpret_cast<char*>(data), text.size());
            return text.size();
        }
    }
    return LLVMFuzzerMutate(data, size, most);
}
