// SPDX-License-Identifier: MIT
#include "log/records/record_table.hpp"

namespace ripplenotch {

RecordSource::RecordSource(Name name, std::vector<std::size_t> sizes)
    : ByteSource(std::move(name)), sizes_(std::move(sizes)) {
    for (std::size_t f = 0; f < sizes_.size(); ++f) {
        kept_.push_back(f);
        record_size_ += sizes_[f];
    }
}

void RecordSource::keep(const std::vector<std::size_t>& fields) {
    std::vector<std::size_t> offsets(sizes_.size(), 0);
    std::size_t offset = 0;
    for (const std::size_t f : kept_) {
        offsets[f] = offset;
        offset += sizes_[f];
    }
    std::string made_ahead;
    for (std::size_t at = given_; at + record_size_ <= bytes_.size(); at += record_size_)
        for (const std::size_t f : fields) made_ahead.append(bytes_, at + offsets[f], sizes_[f]);
    bytes_ = std::move(made_ahead);
    given_ = 0;
    kept_ = fields;
    record_size_ = 0;
    for (const std::size_t f : kept_) record_size_ += sizes_[f];
    chosen();
}

std::size_t RecordSource::read(char* into, std::size_t size) {
    if (given_ == bytes_.size()) {
        bytes_.clear();
        given_ = 0;
        refill(bytes_);
    }
    const std::size_t taken = bytes_.copy(into, size, given_);
    given_ += taken;
    return taken;
}

}  // namespace ripplenotch
