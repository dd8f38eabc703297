// SPDX-License-Identifier: MIT
// Raw dumps: records of numbers without a head, as fwrite() of a struct leaves them.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "log/formats.hpp"
#include "log/records/joined_records.hpp"
#include "log/records/raw_layout.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 3> extensions = {".raw", ".bin", ".f64"};

/// A source whose first bytes have been read already, without those to be skipped.
class Behind final : public ByteSource {
  public:
    Behind(std::unique_ptr<ByteSource> source, std::string first_bytes, std::uint64_t skip)
        : ByteSource(Name{source->name()}), source_(std::move(source)), first_(std::move(first_bytes)) {
        std::string piece(std::min<std::uint64_t>(skip, std::size_t{1} << 16), '\0');
        for (std::uint64_t left = skip; left > 0;) {
            const std::size_t got =
                read(piece.data(), static_cast<std::size_t>(std::min<std::uint64_t>(left, piece.size())));
            if (got == 0) raise<UsageError>("--skip-bytes {}: {} has {} bytes", skip, name(), skip - left);
            left -= got;
        }
    }
    std::size_t read(char* into, std::size_t size) override {
        if (given_ == first_.size()) return source_->read(into, size);
        const std::size_t taken = first_.copy(into, size, given_);
        given_ += taken;
        return taken;
    }

  private:
    std::unique_ptr<ByteSource> source_;
    std::string first_;
    std::size_t given_ = 0;
};

void require_whole_records(const RawLayout& layout, const ByteSource& source, std::uint64_t skip) {
    if (source.size() <= skip) return;  // a pipe says at its end
    const std::uint64_t bytes = source.size() - skip, rest = bytes % layout.record_size;
    if (rest == 0) return;
    const auto fits = layouts_that_fit(layout, bytes);
    raise<DataError>(
        "{}: read {} bytes, expected records of {} bytes (--layout {}): {} whole ones and {} bytes of one "
        "more. If "
        "the dump was cut off: head -c {} {} | ripplenotch ... -. {}{}",
        source.name(), bytes, layout.record_size, layout.text, bytes / layout.record_size, rest,
        skip + bytes - rest, source.name(),
        fits.empty() ? "No layout like it fits; a head before the records is left out by --skip-bytes"
                     : fmt::format("Layouts near it that fit: {}", fmt::join(fits, " or ")),
        fits.empty() && skip == 0 ? fmt::format(" {}", rest) : "");
}

Records make_raw(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    if (!options.records) {
        raise<UsageError>(
            "{}: a raw dump does not say what is in it; say what a record holds, as in --format raw "
            "--layout f8:time_s,f4:velocity_deg_s,f4:torque_nm",
            source->name());
    }
    const RawLayout layout = parse_raw_layout(*options.records);
    require_whole_records(layout, *source, options.skip_bytes);
    RecordTable table;
    table.format = "raw";
    table.fields = layout.fields;
    table.named = layout.named;
    table.record_size = layout.record_size;
    table.options =
        fmt::format("--layout '{}'{}", layout.text,
                    options.skip_bytes > 0 ? fmt::format(" --skip-bytes {}", options.skip_bytes) : "");
    for (std::size_t f = 0; layout.named && f < table.fields.size(); ++f) {
        if (table.fields[f].name.empty()) table.fields[f].name = fmt::format("column {}", f + 1);
    }
    return {std::make_unique<Behind>(std::move(source), std::move(first_bytes), options.skip_bytes),
            std::move(table)};
}

}  // namespace

const LogFormat formats::raw{
    .name = "raw",
    .summary = "records of numbers without a head, told by --layout",
    .extensions = extensions,
    .binary = true,
    .told = true,
    .sniff = [](std::string_view) { return false; },
    .open = open_as_records<make_raw>,
};

}  // namespace ripplenotch
