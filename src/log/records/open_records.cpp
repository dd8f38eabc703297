// SPDX-License-Identifier: MIT
#include "log/records/open_records.hpp"

#include "log/npy/kept_rows.hpp"
#include "log/npy/npy_reader.hpp"

namespace ripplenotch {
namespace {

/// Records that a range kept, with what is needed to read them again.
class KeptRecords final : public ByteSource {
  public:
    KeptRecords(NpyReader& whole, const ReadOptions& options)
        : ByteSource(Name{whole.layout().source}), rows_(whole, options), table_(whole.table()) {
        table_.rows = rows_.cut().kept();
    }
    std::size_t read(char* into, std::size_t size) override { return rows_.read(into, size); }
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const override {
        return rows_.number_in_file(number);
    }
    [[nodiscard]] const RowCut& cut() const { return rows_.cut(); }
    [[nodiscard]] const RecordTable& table() const { return table_; }

  private:
    KeptRows rows_;
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
    auto outside = bytes->cut().outside();
    return {std::move(bytes), whole.layout(), std::move(outside)};
}

}  // namespace ripplenotch
