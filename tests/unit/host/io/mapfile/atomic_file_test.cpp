#include "host/io/mapfile/atomic_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <iterator>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

/// The real operations, but the n-th of all calls that can fail does, and writes take a few bytes at a time.
class FailingOperations final : public FileOperations {
  public:
    explicit FailingOperations(int failing_call) : calls_left_(failing_call) {}

    int create(const char* path) override { return fails(ENOSPC) ? -1 : real_.create(path); }
    int open_directory(const char* path) override { return fails(EACCES) ? -1 : real_.open_directory(path); }
    int copy_attributes(const char* path, int descriptor) override {
        return fails(EPERM) ? -1 : real_.copy_attributes(path, descriptor);
    }
    ssize_t write(int descriptor, const void* bytes, std::size_t count) override {
        return fails(ENOSPC) ? -1 : real_.write(descriptor, bytes, std::min<std::size_t>(count, 5));
    }
    int sync(int descriptor) override { return fails(EIO) ? -1 : real_.sync(descriptor); }
    int close(int descriptor) override {
        const int result = real_.close(descriptor);  // the descriptor is gone whatever close() says
        return fails(EIO) ? -1 : result;
    }
    int rename(const char* from, const char* to) override {
        return fails(EXDEV) ? -1 : real_.rename(from, to);
    }
    int remove(const char* path) override { return real_.remove(path); }

    [[nodiscard]] bool has_failed() const noexcept { return calls_left_ < 0; }

  private:
    bool fails(int error_number) {
        if (calls_left_-- != 0) return false;
        errno = error_number;
        return true;
    }

    FileOperations& real_ = posix_file_operations();
    int calls_left_;
};

/// The real operations.
class RealOperations : public FileOperations {
  public:
    int create(const char* path) override { return real_.create(path); }
    int open_directory(const char* path) override { return real_.open_directory(path); }
    int copy_attributes(const char* path, int descriptor) override {
        return real_.copy_attributes(path, descriptor);
    }
    ssize_t write(int descriptor, const void* bytes, std::size_t count) override {
        return real_.write(descriptor, bytes, count);
    }
    int sync(int descriptor) override { return real_.sync(descriptor); }
    int close(int descriptor) override { return real_.close(descriptor); }
    int rename(const char* from, const char* to) override { return real_.rename(from, to); }
    int remove(const char* path) override { return real_.remove(path); }

  private:
    FileOperations& real_ = posix_file_operations();
};

/// Interrupted before every write that succeeds.
class InterruptedOperations final : public RealOperations {
  public:
    ssize_t write(int descriptor, const void* bytes, std::size_t count) override {
        is_interrupted_ = !is_interrupted_;
        if (is_interrupted_) {
            errno = EINTR;
            return -1;
        }
        return RealOperations::write(descriptor, bytes, std::min<std::size_t>(count, 3));
    }

  private:
    bool is_interrupted_ = false;
};

/// Keeps which steps that last, or can be seen, came in which order.
class OrderedOperations final : public RealOperations {
  public:
    int create(const char* path) override {
        steps += 'c';
        return RealOperations::create(path);
    }
    int sync(int descriptor) override {
        steps += 's';
        return RealOperations::sync(descriptor);
    }
    int rename(const char* from, const char* to) override {
        steps += 'r';
        renamed.push_back(std::filesystem::path(to).filename());
        return RealOperations::rename(from, to);
    }
    std::string steps;
    std::vector<std::string> renamed;
};

ByteSource all_of(std::string_view bytes) {
    return [bytes](const ByteSink& sink) { (void)sink(bytes); };
}

/// Drafts of "new" for files that have "old", in the order of their names; what the draft of the last failed
/// at, or putting them in their places did.
std::optional<SaveStep> save_together(const ScratchFolder& folder, const std::vector<std::string>& names,
                                      FileOperations& operations) {
    std::vector<FileDraft> drafts;
    for (const std::string& name : names) {
        auto draft = FileDraft::write(folder / name, all_of("new"), operations);
        if (!draft) return draft.error().step;
        drafts.push_back(std::move(*draft));
    }
    const auto put = put_in_place(drafts);
    return put ? std::nullopt : std::optional(put.error().step);
}

TEST(AtomicFile, saves_a_new_file_and_replaces_an_old_one) {
    const ScratchFolder folder;
    const auto file = folder / "map.ot";
    EXPECT_TRUE(save_atomically(file, "first").has_value());
    EXPECT_EQ(ScratchFolder::read(file), "first");
    EXPECT_TRUE(save_atomically(file, std::string_view("\0second", 7)).has_value());
    EXPECT_EQ(ScratchFolder::read(file), std::string("\0second", 7));
    EXPECT_TRUE(save_atomically(file, "").has_value());
    EXPECT_EQ(ScratchFolder::read(file), "");
    EXPECT_EQ(folder.entries(), 1);
}

TEST(AtomicFile, survives_a_failure_at_every_single_call) {
    const std::string content = "the new content";  // three writes of five bytes
    // Create, three writes, sync, close, rename, open the folder, sync it. Closing a folder comes after all
    // that: nothing can be lost any more.
    constexpr int kCallsThatMatter = 9;
    for (int failing_call = 0; failing_call < kCallsThatMatter; ++failing_call) {
        const ScratchFolder folder;
        const auto file = folder.write("map.ot", "old");
        FailingOperations operations(failing_call);
        const auto saved = save_atomically(file, content, operations);
        ASSERT_TRUE(operations.has_failed());
        ASSERT_FALSE(saved.has_value()) << "call " << failing_call << " failed and nobody said so";
        EXPECT_NE(saved.error().error_number, 0);
        const bool is_in_place = saved.error().step == SaveStep::sync_directory;
        EXPECT_EQ(ScratchFolder::read(file), is_in_place ? content : "old") << "call " << failing_call;
        EXPECT_EQ(folder.entries(), 1) << "call " << failing_call << " left something behind";
    }
    const ScratchFolder folder;
    FailingOperations operations(kCallsThatMatter);
    EXPECT_TRUE(save_atomically(folder / "map.ot", content, operations).has_value());
    EXPECT_TRUE(operations.has_failed());
}

TEST(AtomicFile, takes_content_in_pieces_and_asks_for_no_more_once_one_is_not_written) {
    const ByteSource content = [](const ByteSink& sink) {
        for (const char* const piece : {"one ", "two ", "", "three"}) {
            if (!sink(piece)) return;
        }
    };
    const ScratchFolder folder;
    const auto file = folder.write("map.ot", "old");
    for (int failing_call = 1; failing_call < 4; ++failing_call) {  // after the creation, three writes
        FailingOperations operations(failing_call);
        const auto saved = save_atomically(file, content, operations);
        ASSERT_FALSE(saved);
        EXPECT_EQ(saved.error().step, SaveStep::write);
        EXPECT_EQ(saved.error().error_number, ENOSPC);
        EXPECT_EQ(ScratchFolder::read(file), "old");
        EXPECT_EQ(folder.entries(), 1);
    }
    EXPECT_TRUE(save_atomically(file, content).has_value());
    EXPECT_EQ(ScratchFolder::read(file), "one two three");
}

TEST(AtomicFile, leaves_the_old_file_and_nothing_else_if_its_content_throws) {
    const auto descriptors = [] {
        const std::filesystem::directory_iterator open_ones("/proc/self/fd");
        return std::distance(begin(open_ones), end(open_ones));
    };
    const ScratchFolder folder;
    const auto file = folder.write("map.ot", "old");
    const auto before = descriptors();
    const ByteSource content = [](const ByteSink& sink) {
        EXPECT_TRUE(sink("half of it"));
        throw std::bad_alloc();
    };
    EXPECT_THROW((void)save_atomically(file, content), std::bad_alloc);
    EXPECT_EQ(ScratchFolder::read(file), "old");
    EXPECT_EQ(folder.entries(), 1);
    EXPECT_EQ(descriptors(), before);
}

TEST(AtomicFile, gives_the_checksum_of_what_it_wrote) {
    const ScratchFolder folder;
    const ByteSource pieces = [](const ByteSink& sink) {
        for (const char* const piece : {"1234", "", "56789"}) EXPECT_TRUE(sink(piece));
    };
    InterruptedOperations operations;
    EXPECT_EQ(save_atomically(folder / "map.ot", pieces, operations).value(), 0xCBF43926U);
    EXPECT_EQ(save_atomically(folder / "map.ot", "").value(), 0U);
    EXPECT_EQ(FileDraft::write(folder / "map.ot", pieces).value().crc(), 0xCBF43926U);
    EXPECT_EQ(folder.entries(), 1) << "the draft that was dropped";
    EXPECT_EQ(ScratchFolder::read(folder / "map.ot"), "");
}

TEST(AtomicFile, renames_what_belongs_together_directly_one_after_the_other) {
    const ScratchFolder folder;
    OrderedOperations operations;
    EXPECT_EQ(save_together(folder, {"b", "a", "c"}, operations), std::nullopt);
    EXPECT_EQ(operations.steps, "cscscsrrrsss");
    EXPECT_EQ(operations.renamed, (std::vector<std::string>{"b", "a", "c"}));
    EXPECT_EQ(folder.entries(), 3);
}

TEST(AtomicFile, leaves_all_old_files_where_one_of_those_that_belong_together_cannot_be_written) {
    constexpr int kCallsBeforeRename = 8;  // of each of the two: create, write, sync, close
    for (int failing_call = 0; failing_call < kCallsBeforeRename + 4; ++failing_call) {
        const ScratchFolder folder;
        folder.write("a", "old");
        folder.write("b", "old");
        FailingOperations operations(failing_call);
        const auto failed = save_together(folder, {"a", "b"}, operations);
        ASSERT_TRUE(failed) << failing_call;
        EXPECT_EQ(folder.entries(), 2) << failing_call;
        const bool has_first = failing_call > kCallsBeforeRename;
        const bool has_second = failing_call > kCallsBeforeRename + 1;
        EXPECT_EQ(ScratchFolder::read(folder / "a"), has_first ? "new" : "old") << failing_call;
        EXPECT_EQ(ScratchFolder::read(folder / "b"), has_second ? "new" : "old") << failing_call;
        EXPECT_EQ(*failed == SaveStep::sync_directory, has_second) << failing_call;
    }
}

TEST(AtomicFile, keeps_the_old_files_mode_where_it_is_asked_to) {
    using std::filesystem::perms;
    const ScratchFolder folder;
    FileOperations& real = posix_file_operations();
    for (const perms mode : {perms{0600}, perms{0640}, perms{0664}, perms{0755}}) {
        const auto file = folder.write("rig.yaml", "old");
        std::filesystem::permissions(file, mode);
        ASSERT_TRUE(save_atomically(file, "new", real, Attributes::of_the_old_file));
        EXPECT_EQ(ScratchFolder::read(file), "new");
        EXPECT_EQ(std::filesystem::status(file).permissions(), mode);
    }
    EXPECT_TRUE(save_atomically(folder / "first", "new", real, Attributes::of_the_old_file));
    const auto kept = folder.write("kept", "old");
    FailingOperations operations(1);  // the call after the creation
    const auto saved = save_atomically(kept, "new", operations, Attributes::of_the_old_file);
    ASSERT_FALSE(saved);
    EXPECT_EQ(saved.error().step, SaveStep::attributes);
    EXPECT_EQ(ScratchFolder::read(kept), "old");
    EXPECT_EQ(folder.entries(), 3);
}

TEST(AtomicFile, goes_on_after_interruptions_and_short_writes) {
    const ScratchFolder folder;
    InterruptedOperations operations;
    EXPECT_TRUE(save_atomically(folder / "map.bt", "0123456789", operations).has_value());
    EXPECT_EQ(ScratchFolder::read(folder / "map.bt"), "0123456789");
}

TEST(AtomicFile, says_which_step_failed_and_why) {
    const ScratchFolder folder;
    const auto missing = save_atomically(folder / "no/such/map.ot", "x");
    ASSERT_FALSE(missing.has_value());
    EXPECT_EQ(missing.error().step, SaveStep::create);
    EXPECT_EQ(missing.error().error_number, ENOENT);
    const Error error = to_error(missing.error());
    EXPECT_EQ(error.code, ErrorCode::system_error);
    EXPECT_EQ(error.file, folder / "no/such/map.ot");
    EXPECT_NE(error.what.find("(No such file or directory); the old file, if any, is unchanged"),
              std::string::npos)
        << error.what;
    EXPECT_EQ(missing.error().message(), error.message());
    std::filesystem::create_directory(folder / "taken.ot");
    const auto taken = save_atomically(folder / "taken.ot", "x");
    ASSERT_FALSE(taken.has_value());
    EXPECT_EQ(taken.error().step, SaveStep::rename);
    EXPECT_EQ(folder.entries(), 1);
    EXPECT_EQ(save_atomically("", "x").error().step, SaveStep::name);
    EXPECT_EQ(to_error(save_atomically("", "x").error()).code, ErrorCode::bad_name);
    EXPECT_EQ(save_atomically(folder.path() / "", "x").error().step, SaveStep::name);
    EXPECT_EQ(save_atomically(folder.path() / "..", "x").error().step, SaveStep::name);
}

TEST(AtomicFile, writes_through_no_link_that_waits_at_its_partial_name) {
    const ScratchFolder folder;
    const auto victim = folder.write("victim", "precious");
    std::filesystem::create_symlink(victim, folder / ".map.ot.octoskin-part");
    EXPECT_TRUE(save_atomically(folder / "map.ot", "x").has_value());
    EXPECT_EQ(ScratchFolder::read(victim), "precious");
    std::filesystem::create_hard_link(victim, folder / ".map.ot.octoskin-part");
    EXPECT_TRUE(save_atomically(folder / "map.ot", "y").has_value());
    EXPECT_EQ(ScratchFolder::read(victim), "precious");
    EXPECT_EQ(ScratchFolder::read(folder / "map.ot"), "y");
    EXPECT_EQ(folder.entries(), 2);
}

TEST(AtomicFile, replaces_a_link_in_the_files_place_and_no_other_name_of_the_file) {
    const ScratchFolder folder;
    const auto victim = folder.write("victim", "precious");
    for (const bool is_hard : {false, true}) {
        std::filesystem::remove(folder / "map.ot");
        is_hard ? std::filesystem::create_hard_link(victim, folder / "map.ot")
                : std::filesystem::create_symlink(victim, folder / "map.ot");
        EXPECT_TRUE(save_atomically(folder / "map.ot", "x").has_value());
        EXPECT_EQ(ScratchFolder::read(victim), "precious");
        EXPECT_EQ(ScratchFolder::read(folder / "map.ot"), "x");
    }
}

TEST(AtomicFile, removes_leftovers_of_a_dead_process_and_nothing_else) {
    const ScratchFolder folder;
    folder.write("map.ot", "kept");
    folder.write(".map.ot.octoskin-part", "half");
    folder.write(".other.octoskin-part", "half");
    folder.write("visible.octoskin-part", "kept");
    folder.write(".hidden", "kept");
    EXPECT_EQ(remove_leftovers(OpenFolder::open(folder.path(), FolderAccess::write).value()), 2U);
    EXPECT_EQ(folder.entries(), 3);
}

}  // namespace
}  // namespace octoskin
