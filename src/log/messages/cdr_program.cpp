// SPDX-License-Identifier: MIT
#include "log/messages/cdr_program.hpp"

#include "log/messages/cdr_cursor.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

void pass_cdr(CdrCursor& cursor, const std::vector<CdrStep>& steps) {
    for (const CdrStep& step : steps) pass_cdr(cursor, step);
}
void pass_cdr(CdrCursor& cursor, const CdrStep& step) {
    switch (step.kind) {
        case CdrStep::Kind::number:
            cursor.take(step.size);
            break;
        case CdrStep::Kind::stamp:
            cursor.take(4, 2);
            break;
        case CdrStep::Kind::skip:
            if (step.count > 0) cursor.take(step.size, step.count);
            break;
        case CdrStep::Kind::skip_any:
            if (const std::uint32_t count = cursor.length(); count > 0) cursor.take(step.size, count);
            break;
        case CdrStep::Kind::text:
            cursor.text();
            break;
        case CdrStep::Kind::texts:
            for (std::uint32_t left = cursor.list_length(); left > 0; --left) cursor.text();
            break;
        case CdrStep::Kind::text_is:
            if (const std::string_view text = cursor.text(); text != step.expected)
                raise<DataError>(
                    "'{}' as {}, expected '{}' as in the first message; record the joints on topics of their "
                    "own",
                    text.substr(0, 60), step.path, step.expected);
            break;
        case CdrStep::Kind::length_is:
            if (const std::uint32_t count = cursor.length(); count != step.count)
                raise<DataError>(
                    "{} elements of {}, expected {} as in the first message; record messages of one shape on "
                    "a topic",
                    count, step.path, step.count);
            break;
        case CdrStep::Kind::repeat_any:
            for (std::uint32_t left = cursor.list_length(); left > 0; --left) pass_cdr(cursor, step.inner);
            break;
    }
}

namespace {

bool keeps(const CdrStep& step) {
    return step.kind == CdrStep::Kind::number || step.kind == CdrStep::Kind::stamp;
}

class CdrReader final : public MessageReader {
  public:
    CdrReader(std::shared_ptr<const std::vector<CdrStep>> steps, const LeafOffsets& offsets)
        : steps_(std::move(steps)), count_(steps_->size()), offsets_(offsets) {
        // Behind the last useful step there is nothing to go on for.
        const auto useful = [&](const CdrStep& step) {
            return keeps(step) ? offsets_[step.leaf] >= 0 : step.kind == CdrStep::Kind::length_is;
        };
        while (count_ > 0 && !useful((*steps_)[count_ - 1])) --count_;
    }
    void read(std::string_view message, char* into) override {
        CdrCursor cursor(message);
        for (std::size_t s = 0; s < count_; ++s) {
            const CdrStep& step = (*steps_)[s];
            if (!keeps(step) || offsets_[step.leaf] < 0) {
                pass_cdr(cursor, step);
            } else if (step.kind == CdrStep::Kind::number) {
                cursor.number(step.size, into + offsets_[step.leaf]);
            } else {
                const std::int64_t stamp = cursor.stamp();
                std::memcpy(into + offsets_[step.leaf], &stamp, sizeof stamp);
            }
        }
    }

  private:
    std::shared_ptr<const std::vector<CdrStep>> steps_;
    std::size_t count_;
    LeafOffsets offsets_;
};

class CdrProgram final : public MessageProgram {
  public:
    explicit CdrProgram(std::vector<CdrStep> steps)
        : steps_(std::make_shared<const std::vector<CdrStep>>(std::move(steps))) {}
    [[nodiscard]] std::unique_ptr<MessageReader> reader(const LeafOffsets& offsets) const override {
        return std::make_unique<CdrReader>(steps_, offsets);
    }

  private:
    std::shared_ptr<const std::vector<CdrStep>> steps_;
};

}  // namespace

std::shared_ptr<const MessageProgram> cdr_program(std::vector<CdrStep> steps) {
    return std::make_shared<CdrProgram>(std::move(steps));
}

}  // namespace ripplenotch
