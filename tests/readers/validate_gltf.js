// Tells what the Khronos glTF validator finds in a file, as JSON: node validate_gltf.js FILE
const fs = require("fs");
const validator = require("gltf-validator");

validator
    .validateBytes(new Uint8Array(fs.readFileSync(process.argv[2])))
    .then((report) => console.log(JSON.stringify(report.issues)));
