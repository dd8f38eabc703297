// SPDX-License-Identifier: MIT
// IN.csv OUT.csv 6|shortest: Polars reads and writes; nothing is filtered.
import polars from 'nodejs-polars';
const [input, output, digits] = process.argv.slice(2);
polars.readCSV(input).writeCSV(output, digits === 'shortest' ? {} : { floatPrecision: Number(digits) });
