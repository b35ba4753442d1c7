// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A SQLite database that is filled row by row, columns by name, or read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/base/status.h"

struct sqlite3;
struct sqlite3_stmt;

namespace pliant {

struct SqliteBlob {
  std::string bytes;
};
using SqliteValue = std::variant<std::nullptr_t, std::int64_t, double, std::string, SqliteBlob>;

enum class SqliteAccess { kWrite, kRead };

class SqliteDatabase {
 public:
  // A database that is there. Fails with kUnreadable if it is none, kUnwritable if it cannot be written or is locked.
  // One that is only read fails with kUnreadable alone, and needs no files beside it that could be
  // written, unless its journal holds something. Nothing in it is computed then: views and virtual tables cannot be
  // read, and no value is longer than the file.
  static Result<SqliteDatabase> Open(const std::string& path, SqliteAccess access = SqliteAccess::kWrite);

  // Names of a table's columns; empty: there is no such table.
  Result<std::vector<std::string>> Columns(const std::string& table);
  // Whether it is a table whose rows have these columns stored in the file: no view, no virtual table and no column
  // that is generated, all of which compute what a query reads, without an end if they are made so.
  Result<bool> IsStored(const std::string& table, const std::vector<std::string>& columns);
  Status Execute(const std::string& sql);

 private:
  friend class SqliteInsert;
  friend class SqliteQuery;
  struct Closer {
    void operator()(sqlite3* database) const;
  };
  SqliteDatabase(std::string path, SqliteAccess access, sqlite3* database)
      : path_(std::move(path)), access_(access), database_(database) {}
  Status Failure(const std::string& what) const;

  std::string path_;
  SqliteAccess access_;
  std::unique_ptr<sqlite3, Closer> database_;
};

// One prepared row: INSERT INTO table (columns) VALUES (?, ...).
class SqliteInsert {
 public:
  // Fails with kMismatch if the table does not have one of the columns.
  static Result<SqliteInsert> Create(SqliteDatabase& database, const std::string& table,
                                     const std::vector<std::string>& columns);
  Status Add(const std::vector<SqliteValue>& values);

  struct Finalizer {
    void operator()(sqlite3_stmt* statement) const;
  };

 private:
  SqliteInsert(SqliteDatabase& database, sqlite3_stmt* statement) : database_(&database), statement_(statement) {}

  SqliteDatabase* database_;
  std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
};

// The rows of a query, one after the other.
class SqliteQuery {
 public:
  // Fails with kUnreadable where the database has no such table or column, or is damaged.
  static Result<SqliteQuery> Create(SqliteDatabase& database, const std::string& sql);

  // False at the end. Fails with kUnreadable.
  Result<bool> Next();
  // Of the present row; 0 or empty where the column has no value of this kind. The text and the bytes are valid until
  // Next.
  std::int64_t Int(int column) const;
  std::string_view Text(int column) const;
  std::string_view Bytes(int column) const;

 private:
  SqliteQuery(SqliteDatabase& database, sqlite3_stmt* statement) : database_(&database), statement_(statement) {}

  SqliteDatabase* database_;
  std::unique_ptr<sqlite3_stmt, SqliteInsert::Finalizer> statement_;
};

}  // namespace pliant
