/** What `calls.ts` finds in each generated module, with the senders of its protocol. */
import * as rt from "../index.js";
export interface Senders {
    readonly device: {
        readonly message: rt.NamedMessage;
        readonly parts: GivenParts;
    };
}
export type MessageInput = rt.NamedMessage;
export interface GivenParts {
    readonly number?: number | undefined;
}
export declare const protocol: rt.Protocol;
