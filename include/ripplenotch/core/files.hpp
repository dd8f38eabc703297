// SPDX-License-Identifier: MIT
#pragma once
// Files as the tool promises them: read whole or in pieces, written under no name and put in place when they
// are complete, never overwritten unasked, "-" is the pipe. docs/reliability.md says what a crash leaves.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace ripplenotch {

class OpenFile;
class Sha256;
class TemporaryFile;

/// A source of bytes: a file, or standard input when the path is "-".
class ByteSource {
  public:
    /// Throws FileError naming the path and the system's reason, UsageError when "-" is a terminal: nobody
    /// wants to type a log, and a tool that waits in silence looks broken.
    explicit ByteSource(const std::string& path);
    /// A file that is open already, read from its start; hashed where inputs are (byte_source.hpp).
    explicit ByteSource(std::shared_ptr<const OpenFile> file);
    /// The same under another name for messages, and not hashed.
    ByteSource(std::shared_ptr<const OpenFile> file, std::string name);
    /// Bytes already in memory, under a name for messages, given out in pieces of at most `piece_size`.
    ByteSource(std::string name, std::shared_ptr<const std::string> bytes,
               std::size_t piece_size = std::size_t(-1));
    virtual ~ByteSource();
    ByteSource(const ByteSource&) = delete;
    ByteSource& operator=(const ByteSource&) = delete;

    /// Reads up to `size` bytes, blocking until at least one is there; 0 means the end. Throws FileError; so
    /// does the end of a file that was written to, cut or made longer since it was opened.
    virtual std::size_t read(char* into, std::size_t size);
    /// As people should see it: the path, or "standard input".
    [[nodiscard]] const std::string& name() const { return name_; }
    /// The bytes of a file when it was opened; 0 where that is not known.
    [[nodiscard]] std::uint64_t size() const { return size_; }
    /// A regular file, which can be read at any place; else bytes come once.
    [[nodiscard]] bool by_place() const;
    /// The file that is by_place(), for readers that go back and forth in it. They pass read() by, so the
    /// file is hashed when its hash is asked for, and refused if it is another by then (byte_source.hpp).
    [[nodiscard]] int descriptor_by_place();
    /// For such readers, at their end: throws FileError if the file was written to since it was opened.
    void require_unchanged() const;

  protected:
    struct Name {
        std::string name;
    };
    /// For derived classes, whose read() gives the bytes.
    explicit ByteSource(Name name);

  private:
    void take(std::string_view bytes);
    void end();

    std::string name_;
    std::shared_ptr<const OpenFile> file_;
    std::shared_ptr<const std::string> bytes_;
    std::unique_ptr<Sha256> hash_;
    std::size_t piece_size_ = 0;
    std::uint64_t size_ = 0, at_ = 0;
    bool ended_ = false;
};

/// Bytes in memory that this process reads where it would open the file of this name, as long as it lives:
/// what one command makes and the next one reads needs no file.
class HeldFile {
  public:
    /// Throws FileError where the system has no memory for it.
    HeldFile(std::string name, std::string_view bytes);
    ~HeldFile();
    HeldFile(const HeldFile&) = delete;
    HeldFile& operator=(const HeldFile&) = delete;

  private:
    std::string name_;
    int descriptor_ = -1;
};

/// Reads a whole file, or standard input when the path is "-".
[[nodiscard]] std::string read_all(const std::string& path);
/// The path as people should see it: "-" is "standard input".
[[nodiscard]] std::string input_name(const std::string& path);

/// Where results go: a file that appears under its name only when finished, or standard output when the path
/// is "-". Destroying an unfinished sink removes what it wrote. A reader that has gone away (| head) ends the
/// process quietly by SIGPIPE's default action.
class ByteSink {
  public:
    /// How a finished file takes its place.
    struct Overwrite {
        bool allowed = false;
        static const Overwrite no, yes;
    };
    /// Throws FileError when the path exists and overwriting was not asked for, or cannot be written.
    /// Throws UsageError when `binary` is true and the sink is a terminal. What is replaced keeps its rights,
    /// owner and group as far as the system allows; a link stays, and the file behind it is replaced.
    ByteSink(const std::string& path, Overwrite overwrite, bool binary = false);
    ~ByteSink();
    ByteSink(const ByteSink&) = delete;
    ByteSink& operator=(const ByteSink&) = delete;

    /// What goes to a file may wait here until there are many pages of it, or until finish().
    void write(std::string_view bytes);
    /// Asks the file system for room of about so many bytes at once, where it can: whole pages of reserved
    /// room are written in half the time, and a full disk shows at the start. What is left over goes back.
    void expect(std::uint64_t bytes);
    /// True when bytes already written can be replaced (a file, not a pipe).
    [[nodiscard]] bool can_rewrite() const { return file_ != nullptr; }
    /// Replaces bytes at an offset from the start; only when can_rewrite().
    void rewrite(std::size_t offset, std::string_view bytes);
    /// Puts the file in its place, with its bytes and its name on the disk unless RIPPLENOTCH_SYNC is none in
    /// the environment; of a pipe, hears what it has to say against the bytes. Throws FileError.
    void finish();

  private:
    void write_pages(std::string_view bytes);
    void write_waiting();
    void close_special();

    std::string path_, target_;            ///< as given; behind links
    std::unique_ptr<TemporaryFile> file_;  ///< none for pipes and devices
    std::string waiting_;                  ///< behind the last whole pages of a file
    std::uint64_t reserved_ = 0, written_ = 0;
    int descriptor_ = -1;
    Overwrite overwrite_;
};
inline constexpr ByteSink::Overwrite ByteSink::Overwrite::no{false};
inline constexpr ByteSink::Overwrite ByteSink::Overwrite::yes{true};

/// Writes a finished text in one go, with the same promises.
void write_all(const std::string& path, std::string_view bytes, ByteSink::Overwrite overwrite);

/// SHA-256 of bytes, fed in pieces, as 64 hexadecimal digits.
class Sha256 {
  public:
    Sha256();
    ~Sha256();
    void update(std::string_view bytes);
    [[nodiscard]] std::string hex();

  private:
    struct Context;
    std::unique_ptr<Context> context_;
};

[[nodiscard]] std::string sha256_of_file(const std::string& path);

// Reading the same bytes twice: a file as it is, a pipe by way of a temporary file.

class Spool {
  public:
    /// A regular file is opened and stays where it is; standard input ("-"), a named pipe or a device is read
    /// to its end into a file without a name in the folder for temporary files (TMPDIR); standard input once,
    /// for all that read it. Throws FileError.
    explicit Spool(const std::string& path);
    ~Spool();
    Spool(const Spool&) = delete;
    Spool& operator=(const Spool&) = delete;

    /// The bytes from their start, under the name that people gave: those of the file that was opened,
    /// whatever has its name by now.
    [[nodiscard]] std::unique_ptr<ByteSource> open() const;

  private:
    std::string path_, name_;
    std::shared_ptr<const OpenFile> file_;
};

// What the ending of a file's name promises about what is in it.

/// Refuses to write one kind of file under the name of another. `what` is what would be written, as "a log",
/// and `endings` those that fit it, with blanks between them: ".csv .npy". Endings that say no kind of file
/// which the tool knows are free, so are names without one. Throws UsageError with the endings that fit.
/// `option`: that was given the name.
void check_output_name(std::string_view path, std::string_view what, std::string_view endings,
                       std::string_view option = "-o");

// What a run read: a file that is read twice is the same both times, and its SHA-256 is that of the bytes
// that were read, whatever has become of the file.

/// From now on a file that this process opens again must be what it was when it was first opened: one that
/// was written to, or gave its name to another, is refused with a FileError. Off at the start; off forgets
/// all.
void watch_inputs(bool wanted);

/// Of the files watched: from now on every ByteSource hashes what it reads, or none does any longer. It takes
/// about a second for a gigabyte on a processor with instructions for it, five without: only for runs that
/// tell.
void hash_inputs(bool wanted);

/// Of the bytes of `path` as they were first read to their end. Where nobody has read it, it is read now.
/// Empty where inputs are watched and not hashed, for then nothing tells it. Throws FileError.
[[nodiscard]] std::string sha256_as_read(const std::string& path);

}  // namespace ripplenotch
