// Runs the Khronos glTF validator over the GLBs named on the command line.
// One JSON line each: {file, errors, warnings, first}. Nothing may lie outside the file itself.
import { readFileSync } from "node:fs";
import validator from "gltf-validator";

for (const file of process.argv.slice(2)) {
  const outside = (uri) => Promise.reject(new Error(`${file} refers to ${uri}; a result is self-contained`));
  try {
    const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
      uri: file,
      maxIssues: 100,
      externalResourceFunction: outside,
    });
    const { numErrors: errors, numWarnings: warnings, messages } = report.issues;
    const worst = messages.find((message) => message.severity === 0);
    const first = worst && `${worst.code} ${worst.pointer}: ${worst.message}`;
    console.log(JSON.stringify({ file, errors, warnings, first }));
  } catch (error) {
    console.log(JSON.stringify({ file, errors: 1, warnings: 0, first: String(error) }));
  }
}
