/** What `calls.ts` finds in each generated module, with the senders of its protocol. */
import * as rt from "../index.js";
