// SPDX-License-Identifier: MIT
// IN.csv OUT.csv: DuckDB reads and writes; nothing is filtered.
import { DuckDBInstance } from '@duckdb/node-api';
const [input, output] = process.argv.slice(2);
const connection = await (await DuckDBInstance.create(':memory:')).connect();
await connection.run(`copy (select * from read_csv('${input}', header = true, all_varchar = false)) to '${output}' (header)`);
