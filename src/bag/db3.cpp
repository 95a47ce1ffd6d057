// SPDX-License-Identifier: BSD-3-Clause
// The sqlite3 storage of rosbag2, in row order, which is the order of recording.
#include <map>
#include <optional>
#include <stdexcept>

#include "chunk.hpp"
#include "formats.hpp"
#include "rio/bag/wire.hpp"

#ifdef RIO_HAS_SQLITE3
#include <sqlite3.h>

namespace rio::bag {

namespace {

/// sqlite replaces bytes past the end of the file by zeros, which would silently change a message
/// whose last page is missing: make it an error.
class NoReadPastTheEnd {
 public:
  explicit NoReadPastTheEnd(sqlite3* db) {
    sqlite3_file* file = nullptr;
    sqlite3_file_control(db, "main", SQLITE_FCNTL_FILE_POINTER, &file);
    if (file == nullptr || file->pMethods == nullptr) return;
    methods_ = *file->pMethods;
    plain_read = methods_.xRead;
    methods_.xRead = [](sqlite3_file* f, void* to, int count, sqlite3_int64 offset) {
      const int code = plain_read(f, to, count, offset);
      return code == SQLITE_IOERR_SHORT_READ ? SQLITE_CORRUPT : code;
    };
    file->pMethods = &methods_;
  }

 private:
  using Read = int (*)(sqlite3_file*, void*, int, sqlite3_int64);
  inline static Read plain_read = nullptr;  ///< one for all files: that of the default VFS
  sqlite3_io_methods methods_{};            ///< outlives the file
};

/// Unless a journal of an unfinished recording is beside it, the file is opened as immutable, so
/// that sqlite writes nothing into its folder.
std::string uri_of(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : path.string()) {
    if (c == '%') uri += "%25";
    if (c == '?') uri += "%3f";
    if (c == '#') uri += "%23";
    if (c != '%' && c != '?' && c != '#') uri += c;
  }
  return std::filesystem::exists(path.string() + "-wal") ? uri : uri + "?immutable=1";
}

class Db3 final : public MessageStream {
 public:
  explicit Db3(const std::filesystem::path& path) : MessageStream(path), file_(path) {
    constexpr sqlite3_int64 kCache = 512 * 1024;  // of all files: pages are read once, in order
    sqlite3_soft_heap_limit64(kCache);
    const int how = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
    if (sqlite3_open_v2(uri_of(path).c_str(), &db_, how, nullptr) != SQLITE_OK) {
      const std::string what = sqlite3_errmsg(db_);
      sqlite3_close(db_);
      throw std::runtime_error(path.string() + ": " + what);
    }
    sqlite3_limit(db_, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxRecord));
    // a truncated file is read as far as it goes; code in its schema must not run
    sqlite3_db_config(db_, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
    sqlite3_db_config(db_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    no_read_past_the_end_.emplace(db_);
  }
  ~Db3() override {
    sqlite3_finalize(statement_);
    sqlite3_close(db_);
  }

  std::string format() const override { return "rosbag2 sqlite3"; }

 private:
  bool read(Message* message) override {
    if (!topics_read_) {
      prepare("SELECT id, name, type, serialization_format FROM topics");
      while (step()) add_topic();
      prepare("SELECT topic_id, timestamp, data, id FROM messages");
      topics_read_ = true;
    }
    if (!step()) return false;
    const auto topic = numbers_.find(sqlite3_column_int64(statement_, 0));
    if (topic == numbers_.end()) fail("a message of an unknown topic");
    message->topic = topic->second;
    message->received = checked_time(sqlite3_column_int64(statement_, 1));
    const void* data = sqlite3_column_blob(statement_, 2);
    const int size = sqlite3_column_bytes(statement_, 2);
    message->data = {static_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size)};
    row_ = sqlite3_column_int64(statement_, 3);
    return true;
  }

  void add_topic() {
    const bool cdr = column_text(3) == "cdr";
    numbers_[sqlite3_column_int64(statement_, 0)] =
        topic_index({column_text(1), ros1_type(column_text(2)),
                     cdr ? Encoding::kCdr : Encoding::kOther, std::string()});
  }

  std::string column_text(int column) {
    const unsigned char* text = sqlite3_column_text(statement_, column);
    return text == nullptr ? "" : reinterpret_cast<const char*>(text);
  }

  void prepare(const char* sql) {
    sqlite3_finalize(statement_);
    statement_ = nullptr;
    if (sqlite3_prepare_v2(db_, sql, -1, &statement_, nullptr) != SQLITE_OK) {
      fail(sqlite3_errmsg(db_));
    }
  }

  bool step() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) fail(sqlite3_errmsg(db_));
    return code == SQLITE_ROW;
  }

  /// sqlite gives no position: the end of the file if it is truncated, else its beginning.
  [[noreturn]] void fail(const std::string& what) {
    std::vector<std::uint8_t> head;
    file_.read(0, 32, &head);
    const std::uint32_t field = number_at<std::uint16_t>(head.data() + 16, true);
    const std::uint64_t page = field == 1 ? 65536 : field;
    const std::uint64_t pages = number_at<std::uint32_t>(head.data() + 28, true);
    const bool cut = file_.size() < page * pages;
    throw Damage(cut ? file_.size() : 0, (cut ? "the file ends here, its content does not: " : "") +
                                             what + ", after message " + std::to_string(row_));
  }

  FileBytes file_;
  std::optional<NoReadPastTheEnd> no_read_past_the_end_;
  sqlite3* db_ = nullptr;
  sqlite3_stmt* statement_ = nullptr;
  bool topics_read_ = false;
  std::int64_t row_ = 0;                         ///< of the last message
  std::map<std::int64_t, std::size_t> numbers_;  ///< number of the topic -> index
};

}  // namespace

}  // namespace rio::bag

#endif

std::unique_ptr<rio::bag::MessageStream> rio::bag::open_db3(const std::filesystem::path& path) {
#ifdef RIO_HAS_SQLITE3
  return std::make_unique<Db3>(path);
#else
  throw std::runtime_error(path.string() +
                           ": sqlite3 recordings need libsqlite3, which rio was built without: "
                           "install libsqlite3-dev and build again");
#endif
}
