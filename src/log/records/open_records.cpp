// SPDX-License-Identifier: MIT
#include "log/records/open_records.hpp"

#include <cmath>

#include "log/npy/npy_reader.hpp"
#include "log/npy/temporary_bytes.hpp"
#include "log/row_cut.hpp"

namespace ripplenotch {
namespace {

/// Records that a range kept, with what is needed to read them again.
class KeptRecords final : public ByteSource {
  public:
    KeptRecords(NpyReader& whole, const ReadOptions& options)
        : ByteSource(Name{whole.layout().source}), cut_(options, whole.layout()), table_(whole.table()) {
        const std::size_t size = whole.header().record_size;
        const bool timed = whole.layout().chosen.time.has_value();
        RowBlock block;
        while (whole.fetch(block)) {
            const std::string_view bytes = block.bytes;
            for (std::size_t at = 0; at < bytes.size(); at += size) {
                std::optional<double> time;
                if (timed) time = whole.time_of(bytes.data() + at);
                const bool stays = cut_.keeps(time && std::isfinite(*time) ? time : std::nullopt);
                numbers_.add(stays);
                if (stays) rows_.put(bytes.substr(at, size));
            }
        }
        cut_.require_rows();
        table_.rows = cut_.kept();
        rows_.rewind();
    }
    std::size_t read(char* into, std::size_t size) override { return rows_.read(into, size); }
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const override {
        return numbers_.in_file(number);
    }
    [[nodiscard]] const RowCut& rows() const { return cut_; }
    [[nodiscard]] const RecordTable& table() const { return table_; }

  private:
    RowCut cut_;
    KeptNumbers numbers_;
    TemporaryBytes rows_;
    RecordTable table_;
};

}  // namespace

std::unique_ptr<LogReader> read_records(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                        const ReadOptions& options, MakeRecords make) {
    if (const auto* const kept = dynamic_cast<const KeptRecords*>(source.get())) {
        RecordTable table = kept->table();
        return std::make_unique<NpyReader>(std::move(source), std::move(table), options);
    }
    Records records = make(std::move(source), std::move(first_bytes), options);
    return std::make_unique<NpyReader>(std::move(records.bytes), std::move(records.table), options);
}

LogCut cut_records(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options,
                   MakeRecords make) {
    Records records = make(std::move(source), std::move(first_bytes), options);
    NpyReader whole(std::move(records.bytes), std::move(records.table), clock_only(options), true);
    auto bytes = std::make_unique<KeptRecords>(whole, options);
    auto outside = bytes->rows().outside();
    return {std::move(bytes), whole.layout(), std::move(outside)};
}

}  // namespace ripplenotch
