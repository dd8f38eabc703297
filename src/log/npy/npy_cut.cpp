// SPDX-License-Identifier: MIT
#include "log/npy/npy_cut.hpp"

#include <fmt/format.h>

#include "log/npy/kept_rows.hpp"
#include "log/npy/npy_reader.hpp"

namespace ripplenotch {
namespace {

class NpyCut : public ByteSource {
  public:
    NpyCut(NpyReader& whole, const ReadOptions& options)
        : ByteSource(Name{whole.layout().source}), rows_(whole, options) {
        const NpyHeader& header = whole.header();
        const std::size_t kept = rows_.cut().kept();
        const std::string shape =
            header.structured ? fmt::format("{},", kept) : fmt::format("{}, {}", kept, header.fields.size());
        head_ = make_npy_header(header.descr, shape, false);
    }

    std::size_t read(char* into, std::size_t size) override {
        if (given_ == head_.size()) return rows_.read(into, size);
        const std::size_t taken = head_.copy(into, size, given_);
        given_ += taken;
        return taken;
    }
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const override {
        return rows_.number_in_file(number);
    }
    [[nodiscard]] const RowCut& cut() const { return rows_.cut(); }

  private:
    KeptRows rows_;
    std::string head_;
    std::size_t given_ = 0;  ///< of head_
};

}  // namespace

LogCut cut_npy(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    NpyReader whole(std::move(source), std::move(first_bytes), clock_only(options));
    auto bytes = std::make_unique<NpyCut>(whole, options);
    auto outside = bytes->cut().outside();
    return {std::move(bytes), whole.layout(), std::move(outside)};
}

}  // namespace ripplenotch
