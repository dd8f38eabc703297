// SPDX-License-Identifier: MIT
// Raw dumps: records of numbers without a head, as fwrite() of a struct leaves them.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "log/npy/npy_header.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 3> extensions = {".raw", ".bin", ".f64"};
constexpr std::size_t largest_raw_record = std::size_t{1} << 16;

[[noreturn]] void complain(std::string_view field, std::string_view why) {
    raise<UsageError>(
        "--layout: '{}': {}; write fields as f8,f4,i2*0.01:torque_nm, with f4 f8 i1 i2 i4 i8 u1 u2 u4 u8, x4 "
        "for 4 bytes to skip, and < or > in front for the byte order",
        field, why);
}

double number_in(std::string_view field, std::string_view text) {
    const auto number = parse_number(text);
    if (!number) complain(field, fmt::format("'{}' is no number", text));
    return *number;
}

// "*0.01+3", "*-0.5-1e-3", "+3": the last sign that is not of an exponent begins the shift.
void read_scale(std::string_view field, std::string_view text, NpyField& into) {
    std::size_t shift = std::string_view::npos;
    for (std::size_t i = text.size(); i-- > 0;) {
        const bool sign = text[i] == '+' || text[i] == '-';
        const bool of_number = i > 0 && (text[i - 1] == 'e' || text[i - 1] == 'E' || text[i - 1] == '*');
        if (sign && !of_number) {
            shift = i;
            break;
        }
    }
    const std::string_view scale = text.substr(0, std::min(shift, text.size()));
    if (!scale.empty()) into.scale = number_in(field, scale.substr(1));
    if (shift != std::string_view::npos) {
        const std::string_view number = text.substr(text[shift] == '+' ? shift + 1 : shift);
        into.shift = number_in(field, number);
    }
}

/// --layout: what stands in a record of a raw dump, in the words of C and NumPy.
struct RawLayout {
    std::vector<NpyField> fields;
    std::size_t record_size = 0;
    bool named = false;  ///< one field at least says its name
    std::string text;    ///< as it was given
};

// "f8,f4,f4", "<i2*0.01:torque_nm", ">u4*1e-6:time_s,x4,f8:q". Fields follow each other without room between;
// x4 is four bytes that are no number. '<' (the default) and '>' hold until the next one. Throws UsageError.
RawLayout parse_raw_layout(const std::string& text) {
    RawLayout layout;
    layout.text = text;
    bool big_endian = false;
    for (const std::string_view whole : split(text, ',')) {
        std::string_view rest = whole;
        if (!rest.empty() && (rest.front() == '<' || rest.front() == '>')) {
            big_endian = rest.front() == '>';
            rest.remove_prefix(1);
        }
        NpyField field;
        if (const std::size_t colon = rest.find(':'); colon != std::string_view::npos) {
            field.name = rest.substr(colon + 1);
            rest = rest.substr(0, colon);
            layout.named = true;
        }
        const std::string_view word = rest.substr(0, rest.find_first_of("*+-"));
        if (word.starts_with('x')) {
            const double bytes = word.size() == 1 ? 1.0 : number_in(whole, word.substr(1));
            if (!(bytes >= 1.0 && bytes <= static_cast<double>(largest_raw_record)))
                complain(whole, "skips no bytes");
            layout.record_size += static_cast<std::size_t>(bytes);
            continue;
        }
        const auto type = number_type(word == "float" ? "f4" : word == "double" ? "f8" : word);
        if (!type) complain(whole, fmt::format("'{}' is no type of numbers", word));
        field.kind = type->kind;
        field.size = type->size;
        field.big_endian = big_endian;
        read_scale(whole, rest.substr(word.size()), field);
        field.offset = layout.record_size;
        layout.record_size += field.size;
        layout.fields.push_back(field);
        if (layout.record_size > largest_raw_record) complain(whole, "a record of more than 64 KiB");
    }
    if (layout.fields.empty()) complain(text, "names no numbers");
    return layout;
}

// Layouts like this one whose records fit into `bytes` without remainder, the nearest first, two at most:
// with bytes to be skipped added, or fields left out at the end.
std::vector<std::string> layouts_that_fit(const RawLayout& layout, std::uint64_t bytes) {
    struct Candidate {
        std::size_t distance;
        std::string text;
    };
    constexpr std::size_t most_skipped = 64;
    std::vector<Candidate> candidates;
    for (std::size_t more = 1; more <= most_skipped; ++more) {
        if (bytes % (layout.record_size + more) == 0)
            candidates.push_back({more, fmt::format("{},x{}", layout.text, more)});
    }
    std::string shorter = layout.text;
    for (std::size_t left = layout.fields.size(); left > 1; --left) {
        const std::size_t comma = shorter.rfind(',');
        if (comma == std::string::npos) break;
        shorter.resize(comma);
        const std::size_t size = parse_raw_layout(shorter).record_size;
        if (bytes % size == 0) candidates.push_back({layout.record_size - size, shorter});
    }
    std::ranges::stable_sort(candidates,
                             [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < std::min<std::size_t>(2, candidates.size()); ++i)
        texts.push_back(candidates[i].text);
    return texts;
}

void require_whole_records(const RawLayout& layout, const ByteSource& source) {
    const std::uint64_t bytes = source.size(), rest = bytes % layout.record_size;
    if (rest == 0) return;  // of a pipe the size is 0; it says at its end
    const auto fits = layouts_that_fit(layout, bytes);
    raise<DataError>(
        "{}: read {} bytes, expected records of {} bytes (--layout {}): {} whole ones and {} bytes of one "
        "more. If the dump was cut off: head -c {} {} | ripplenotch ... -. {}",
        source.name(), bytes, layout.record_size, layout.text, bytes / layout.record_size, rest, bytes - rest,
        source.name(),
        fits.empty() ? fmt::format("No layout like it fits; a head before the records is left out by tail -c "
                                   "+{} {} | ripplenotch ... -",
                                   rest + 1, source.name())
                     : fmt::format("Layouts near it that fit: {}", fmt::join(fits, " or ")));
}

ColumnLog make_raw(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    if (!options.records) {
        raise<UsageError>(
            "{}: a raw dump does not state what is in it; state what a record holds, as in --format raw "
            "--layout f8:time_s,f4:velocity_deg_s,f4:torque_nm",
            source->name());
    }
    const RawLayout layout = parse_raw_layout(*options.records);
    require_whole_records(layout, *source);
    NpyHeader header;
    header.fields = layout.fields;
    header.structured = layout.named;
    header.record_size = layout.record_size;
    header.rows = rows_unknown;
    for (std::size_t f = 0; layout.named && f < header.fields.size(); ++f) {
        if (header.fields[f].name.empty()) header.fields[f].name = fmt::format("column {}", f + 1);
    }
    ColumnLog log;
    log.format = "raw";
    log.options = fmt::format("--layout '{}'", layout.text);
    log.columns = std::make_unique<RecordColumns>(std::move(source), std::move(first_bytes),
                                                  std::move(header), std::string());
    return log;
}

}  // namespace

const LogFormat formats::raw{
    .name = "raw",
    .summary = "records of numbers without a header, described by --layout",
    .extensions = extensions,
    .binary = true,
    .told = true,
    .sniff = [](std::string_view) { return false; },
    .columns = make_raw,
};

}  // namespace ripplenotch
