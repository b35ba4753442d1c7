// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/sqlite.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>

#include <sqlite3.h>

#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr int kBusyMs = 2000;  // how long another process may hold a lock

int Bind(sqlite3_stmt* statement, int index, const SqliteValue& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return sqlite3_bind_int64(statement, index, *whole);
  if (const auto* number = std::get_if<double>(&value)) return sqlite3_bind_double(statement, index, *number);
  if (const auto* text = std::get_if<std::string>(&value))
    return sqlite3_bind_text64(statement, index, text->data(), text->size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  if (const auto* blob = std::get_if<SqliteBlob>(&value))
    return sqlite3_bind_blob64(statement, index, blob->bytes.data(), blob->bytes.size(), SQLITE_TRANSIENT);
  return sqlite3_bind_null(statement, index);
}

// Whether a database cannot be read because its journal (WAL) wants files beside it, as on read-only media, and may be
// read as it is. One whose journal holds something may not: it would be read without its last changes.
bool MayBeReadAsUnchanging(sqlite3* database) {
  if (sqlite3_exec(database, "SELECT 1 FROM sqlite_master", nullptr, nullptr, nullptr) != SQLITE_CANTOPEN) return false;
  std::error_code error;
  const std::string file = sqlite3_db_filename(database, "main");  // where a link leads to
  const auto journal_bytes = std::filesystem::file_size(file + "-wal", error);
  return error ? error == std::errc::no_such_file_or_directory : journal_bytes == 0;
}

// A database is a program, too. Of one that is only read nothing is run, and what it says of lengths is not believed.
void Distrust(sqlite3* database) {
  for (const int allowed : {SQLITE_DBCONFIG_ENABLE_VIEW, SQLITE_DBCONFIG_TRUSTED_SCHEMA})
    sqlite3_db_config(database, allowed, 0, static_cast<int*>(nullptr));
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, static_cast<int*>(nullptr));
  sqlite3_drop_modules(database, nullptr);
  constexpr std::uintmax_t kFewestBytes = 1 << 20;  // of what SQLite itself puts together
  constexpr std::uintmax_t kMostBytes = std::numeric_limits<int>::max();
  std::uintmax_t bytes = kFewestBytes;
  const std::string file = sqlite3_db_filename(database, "main");
  for (const std::string& path : {file, file + "-wal"}) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (!error) bytes = std::min(bytes + size, kMostBytes);
  }
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(bytes));  // at most that of its build
}

// By which SQLite takes a file as one that nobody writes.
std::string UnchangingUri(const std::string& path) {
  std::string uri = "file://";
  std::error_code error;
  for (const char c : std::filesystem::absolute(path, error).string()) {
    if (c == '%')
      uri += "%25";
    else if (c == '?')
      uri += "%3F";
    else if (c == '#')
      uri += "%23";
    else
      uri += c;
  }
  return uri + "?immutable=1";
}

}  // namespace

void SqliteDatabase::Closer::operator()(sqlite3* database) const { sqlite3_close_v2(database); }
void SqliteInsert::Finalizer::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Status SqliteDatabase::Failure(const std::string& what) const {
  const int code = sqlite3_errcode(database_.get());
  const std::string message =
      "cannot " + what + " the database " + Quoted(path_) + ": " + sqlite3_errmsg(database_.get());
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED)
    return {access_ == SqliteAccess::kRead ? ErrorCode::kUnreadable : ErrorCode::kUnwritable,
            message + "; another program has it open; close that program first"};
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT || access_ == SqliteAccess::kRead)
    return {ErrorCode::kUnreadable, message};
  return {ErrorCode::kUnwritable, message};
}

Result<SqliteDatabase> SqliteDatabase::Open(const std::string& path, SqliteAccess access) {
  sqlite3* handle = nullptr;
  const int flags = access == SqliteAccess::kRead ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE;
  int code = sqlite3_open_v2(path.c_str(), &handle, flags, nullptr);
  SqliteDatabase database(path, access, handle);
  if (code == SQLITE_OK && access == SqliteAccess::kRead && MayBeReadAsUnchanging(handle)) {
    code = sqlite3_open_v2(UnchangingUri(path).c_str(), &handle, flags | SQLITE_OPEN_URI, nullptr);
    database = SqliteDatabase(path, access, handle);
  }
  if (code != SQLITE_OK) return database.Failure("open");
  sqlite3_busy_timeout(handle, kBusyMs);
  if (access == SqliteAccess::kRead) Distrust(handle);
  return database;
}

Status SqliteDatabase::Execute(const std::string& sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) return Failure("write");
  return Status::Ok();
}

Result<std::vector<std::string>> SqliteDatabase::Columns(const std::string& table) {
  sqlite3_stmt* handle = nullptr;
  if (sqlite3_prepare_v2(database_.get(), "SELECT name FROM pragma_table_info(?)", -1, &handle, nullptr) != SQLITE_OK)
    return Failure("read");
  const std::unique_ptr<sqlite3_stmt, SqliteInsert::Finalizer> statement(handle);
  sqlite3_bind_text(handle, 1, table.c_str(), -1, SQLITE_TRANSIENT);
  std::vector<std::string> names;
  int code = SQLITE_OK;
  while ((code = sqlite3_step(handle)) == SQLITE_ROW)
    names.emplace_back(reinterpret_cast<const char*>(sqlite3_column_text(handle, 0)));
  if (code != SQLITE_DONE) return Failure("read");
  return names;
}

Result<bool> SqliteDatabase::IsStored(const std::string& table, const std::vector<std::string>& columns) {
  // Asked first: to list the columns of a view is to look through all that it is made of.
  for (const std::string& column : columns) {
    const int code = sqlite3_table_column_metadata(database_.get(), "main", table.c_str(), column.c_str(), nullptr,
                                                   nullptr, nullptr, nullptr, nullptr);
    if (code == SQLITE_ERROR) return false;
    if (code != SQLITE_OK) return Failure("read");
  }
  const auto stored = Columns(table);  // without those that are generated
  if (!stored.ok()) return stored.status();
  return std::all_of(columns.begin(), columns.end(), [&](const std::string& column) {
    return std::find(stored->begin(), stored->end(), column) != stored->end();
  });
}

Result<SqliteInsert> SqliteInsert::Create(SqliteDatabase& database, const std::string& table,
                                          const std::vector<std::string>& columns) {
  const auto known = database.Columns(table);
  if (!known.ok()) return known.status();
  std::string placeholders;
  for (const std::string& column : columns) {
    if (std::find(known->begin(), known->end(), column) == known->end())
      return Status(ErrorCode::kMismatch, "the database " + Quoted(database.path_) + " has no column " + column +
                                              " in a table " + table + "; this version does not know its layout");
    placeholders += placeholders.empty() ? "?" : ", ?";
  }
  sqlite3_stmt* handle = nullptr;
  const std::string sql = "INSERT INTO " + table + " (" + CommaSeparated(columns) + ") VALUES (" + placeholders + ")";
  if (sqlite3_prepare_v2(database.database_.get(), sql.c_str(), -1, &handle, nullptr) != SQLITE_OK)
    return database.Failure("write");
  return SqliteInsert(database, handle);
}

Status SqliteInsert::Add(const std::vector<SqliteValue>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (Bind(statement_.get(), static_cast<int>(i) + 1, values[i]) != SQLITE_OK) return database_->Failure("write");
  if (sqlite3_step(statement_.get()) != SQLITE_DONE) return database_->Failure("write");
  sqlite3_reset(statement_.get());
  return Status::Ok();
}

Result<SqliteQuery> SqliteQuery::Create(SqliteDatabase& database, const std::string& sql) {
  sqlite3_stmt* handle = nullptr;
  if (sqlite3_prepare_v2(database.database_.get(), sql.c_str(), -1, &handle, nullptr) != SQLITE_OK)
    return database.Failure("read");
  return SqliteQuery(database, handle);
}

Result<bool> SqliteQuery::Next() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return database_->Failure("read");
}

std::int64_t SqliteQuery::Int(int column) const { return sqlite3_column_int64(statement_.get(), column); }

std::string_view SqliteQuery::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  if (text == nullptr) return {};
  return {text, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

std::string_view SqliteQuery::Bytes(int column) const {
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_.get(), column));
  if (bytes == nullptr) return {};
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

}  // namespace pliant
