"use strict";
document.getElementById("report").textContent = JSON.stringify(JSON.parse(document.getElementById("data").textContent).numbers);
